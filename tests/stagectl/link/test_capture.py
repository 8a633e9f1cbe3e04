"""Blocks kept by their number, and what is not relied on."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from stagectl.link.account import Status
from stagectl.link.capture import Capture

NAMES = ("position", "extension", "voltage")
FIRST_COUNTER, FIRST_REFERENCE, PLAYED_IN = 65_530, 65_500, 65_545
"""Both counters pass their end; the first reference is played 15 blocks after the first that is heard."""


def status(block: int, **others: int) -> Status:
    waiting = 40
    reference = (FIRST_REFERENCE + block - 1 - PLAYED_IN + waiting) % 65_536
    return replace(Status(0.0, block, 0, 0, 0, 0, 0, reference, waiting, 0.0), **others)


def captured(blocks: int = 300, without: tuple[tuple[str, int], ...] = (), **others: int) -> Capture:
    """Return what 300 blocks leave, each filled with its number, with a status every 100, `others` from the second."""
    capture = Capture(400)
    for number in range(blocks):
        counter = FIRST_COUNTER + number
        for name in NAMES:
            if (name, number) not in without:
                capture.take(name, counter % 65_536, np.full((10, 3), float(number)))
        if number % 100 == 99:
            capture.report(status(counter + 1, **(others if number > 100 else {})))
    return capture


def test_a_reference_is_found_in_the_block_that_it_was_played_in() -> None:
    capture = captured()
    assert capture.start(FIRST_REFERENCE, 250) == 15
    position = capture.samples("position", 15 + 50, 200)
    assert isinstance(position, np.ndarray)
    np.testing.assert_array_equal(position[::10, 1], np.arange(65.0, 265.0))


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: captured(50), "no status came from the stage"),
        (lambda: captured(250), "of 250 blocks, 234 were played"),
        (lambda: captured(underruns=1), "the stage had to wait for the host"),
        (lambda: captured(waiting=39), "the stage had to wait for the host"),
        (lambda: captured(lost=2), "of the blocks to the stage, 2 were lost"),
        (lambda: captured(late=1), "of the blocks to the stage, 1 were late"),
        (lambda: captured(garbled=1), "of the blocks to the stage, 1 were garbled"),
    ],
)
def test_what_was_not_played_as_it_should_is_told(make: Callable[[], Capture], text: str) -> None:
    assert make().start(FIRST_REFERENCE, 250) == text


def test_blocks_that_did_not_come_are_told_and_only_where_they_are_wanted() -> None:
    capture = captured(without=(("extension", 70), ("extension", 71)))
    assert capture.samples("extension", 65, 200) == "of the stage's blocks of extension, 2 were lost"
    assert isinstance(capture.samples("extension", 72, 200), np.ndarray)
    assert isinstance(capture.samples("voltage", 65, 200), np.ndarray)


def test_more_than_it_has_room_for_is_left_out() -> None:
    capture = captured(500)
    assert capture.newest == 499
    assert capture.start(FIRST_REFERENCE, 390) == "of 390 blocks, 484 were played"
