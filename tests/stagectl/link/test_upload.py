"""An upload through a link that loses, changes and refuses."""

from typing import Any

import numpy as np
import pytest

from firmware_sim.parameter_store import ParameterStore
from stagectl.link.bus import LinkError
from stagectl.link.config import Link
from stagectl.link.upload import upload
from stagectl.wire.messages import Command, Result

SET = {"gains": np.arange(300.0).reshape(3, 100)}


class FaultyLink:
    """A stage's store behind a link; `lose` and `change` say what happens to which piece, by its number of order."""

    def __init__(self, lose: Any = (), change: Any = ()) -> None:
        self.link, self.taken = Link(), dict[str, np.ndarray]()
        self.store = ParameterStore(self.taken.update)
        self.lose, self.change, self.pieces = lose, change, 0
        self.back: dict[int, bytes] = {}

    def write(self, pieces: list[tuple[int, bytes]]) -> None:
        for number, data in pieces:
            self.pieces += 1
            if self.pieces not in self.lose:
                self.store.write(number, data)

    def ask(self, command: Command, argument: int) -> tuple[Result, int]:
        if command is Command.BEGIN:
            return self.store.begin(argument), 0
        if command is Command.CHECK:
            return Result.DONE, self.store.received
        if command is Command.COMMIT:
            return self.store.commit(argument), 0
        for number, data in self.store.read(argument):
            self.pieces += 1
            if self.pieces not in self.lose:
                self.back[number] = bytes(58) if self.pieces in self.change else data
        return Result.DONE, 0

    def read(self, numbers: range) -> dict[int, bytes]:
        return {number: self.back.pop(number) for number in numbers if number in self.back}


def test_lost_pieces_are_sent_again_both_ways() -> None:
    link = FaultyLink(lose={1, 5, 17, 30, 60, 61, 80, 90})
    upload(link, SET)  # type: ignore[arg-type]
    np.testing.assert_array_equal(link.taken["gains"], SET["gains"])


def test_a_piece_that_comes_back_changed_ends_it_before_it_is_used() -> None:
    link = FaultyLink(change=range(50, 52))
    with pytest.raises(LinkError, match=r"chunk \d+ of 42 of the parameters came back changed"):
        upload(link, SET)  # type: ignore[arg-type]
    assert link.taken == {}


def test_a_piece_that_never_arrives_ends_it() -> None:
    with pytest.raises(LinkError, match="chunk 0 of 42 of the parameters does not arrive"):
        upload(FaultyLink(lose=range(10_000)), SET)  # type: ignore[arg-type]


def test_a_piece_that_never_comes_back_ends_it() -> None:
    with pytest.raises(LinkError, match="chunk 0 of 42 of the parameters does not come back"):
        upload(FaultyLink(lose=range(43, 10_000)), SET)  # type: ignore[arg-type]
