"""The stage's parameters: nothing is in use before it is whole, right and taken."""

from collections.abc import Mapping

import numpy as np

from firmware_sim.parameter_store import ParameterStore
from stagectl.wire.messages import WINDOW, Result
from stagectl.wire.parameters import LARGEST, checksum, chunks, pack_parameters

SET = {"gains": np.arange(100.0).reshape(10, 10)}
IMAGE = pack_parameters(SET)
PIECES = chunks(IMAGE, 58)


def filled(pieces: list[bytes], taken: list[Mapping[str, np.ndarray]]) -> ParameterStore:
    store = ParameterStore(taken.append)
    assert store.begin(len(IMAGE)) is Result.DONE
    for number, data in enumerate(pieces):
        store.write(number, data)
    return store


def test_a_whole_set_is_put_into_use() -> None:
    taken: list[Mapping[str, np.ndarray]] = []
    store = filled(PIECES, taken)
    assert store.commit(checksum(IMAGE)) is Result.DONE
    np.testing.assert_array_equal(taken[0]["gains"], SET["gains"])
    assert store.in_use == checksum(IMAGE)


def test_it_is_read_back_as_it_was_written() -> None:
    store = filled(PIECES, [])
    assert store.read(0) == list(enumerate(PIECES))[:WINDOW]
    assert store.read(len(PIECES) - 1) == [(len(PIECES) - 1, PIECES[-1])]
    assert store.read(len(PIECES)) == []


def test_chunks_out_of_order_are_passed_over() -> None:
    store = ParameterStore(lambda _: None)
    store.begin(len(IMAGE))
    store.write(1, PIECES[1])
    store.write(0, PIECES[0])
    store.write(0, PIECES[0])
    assert store.received == 1
    assert store.commit(checksum(IMAGE)) is Result.INCOMPLETE


def test_chunks_beyond_the_size_are_passed_over() -> None:
    store = filled([*PIECES, PIECES[0]], [])
    assert store.received == len(PIECES)


def test_a_changed_set_or_another_one_is_refused() -> None:
    taken: list[Mapping[str, np.ndarray]] = []
    store = filled([bytes(58), *PIECES[1:]], taken)
    assert store.commit(checksum(IMAGE)) is Result.WRONG_CHECKSUM
    store = filled(PIECES, taken)
    assert store.commit(checksum(IMAGE) ^ 1) is Result.WRONG_CHECKSUM
    assert (taken, store.in_use) == ([], 0)


def test_a_set_that_the_loops_refuse_changes_nothing() -> None:
    def refuse(_: Mapping[str, np.ndarray]) -> None:
        raise ValueError("no")

    store = ParameterStore(refuse)
    store.begin(len(IMAGE))
    for number, data in enumerate(PIECES):
        store.write(number, data)
    assert store.commit(checksum(IMAGE)) is Result.REFUSED
    assert store.in_use == 0


def test_a_size_that_cannot_be_is_refused() -> None:
    store = ParameterStore(lambda _: None)
    assert [store.begin(size) for size in (0, LARGEST + 1, LARGEST)] == [
        Result.WRONG_SIZE,
        Result.WRONG_SIZE,
        Result.DONE,
    ]
