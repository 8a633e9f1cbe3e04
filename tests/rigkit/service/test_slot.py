"""The newest of something, across processes."""

import multiprocessing

import pytest

from rigkit.service.slot import CAPACITY, Slot
from tests.until import until


def test_there_is_nothing_first_and_then_the_newest() -> None:
    slot = Slot()
    assert slot.get() is None
    slot.put(b"old and long")
    slot.put(b"new")
    assert slot.get() == b"new"


def test_what_does_not_fit_is_refused_and_what_was_there_stays() -> None:
    slot = Slot()
    slot.put(b"here")
    with pytest.raises(ValueError, match=f"must be <= {CAPACITY}"):
        slot.put(bytes(CAPACITY + 1))
    assert slot.get() == b"here"


def write(slot: Slot, values: int) -> None:
    """Write buffers that are whole where all their bytes are alike."""
    for value in range(1, values + 1):
        slot.put(bytes([value % 256]) * (1000 * (value % 7 + 1)))


def test_a_reader_in_another_process_never_gets_a_mixture() -> None:
    slot, values = Slot(), 3000
    writer = multiprocessing.get_context("spawn").Process(target=write, args=(slot, values))
    writer.start()
    mixed = 0

    def read() -> bool:
        nonlocal mixed
        content = slot.get()
        mixed += content is not None and len(set(content)) != 1
        return slot.count == 2 * values

    until(read)
    writer.join()
    assert mixed == 0


def test_a_writer_that_died_at_work_leaves_nothing_rather_than_a_mixture() -> None:
    slot = Slot()
    slot.put(b"whole")
    slot._words[0] += 1  # noqa: SLF001  # as `put` begins
    assert slot.get() is None
