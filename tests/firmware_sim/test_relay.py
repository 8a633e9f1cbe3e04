"""The simulated relay closes for a counter that moves on, and for nothing else."""

import pytest

from firmware_sim.relay import Relay
from rigkit.relay.frame import IDENTIFIER, heartbeat

FRAME = heartbeat()
PATIENCE = 0.2


def relay_that_heard(*counters: int, every: float = 0.05) -> Relay:
    """Return a relay that has heard frames from the time 0 on."""
    made = Relay(IDENTIFIER, PATIENCE)
    for number, counter in enumerate(counters):
        made.take(IDENTIFIER, FRAME.pack(counter, 0), number * every)
    return made


def test_it_is_open_until_a_counter_has_moved_and_again_after_its_patience() -> None:
    assert not Relay(IDENTIFIER, PATIENCE).is_closed(0.0)
    assert not relay_that_heard(7).is_closed(0.0)
    moved = relay_that_heard(7, 8)
    assert moved.is_closed(0.05)
    assert moved.is_closed(0.05 + PATIENCE)
    assert not moved.is_closed(0.06 + PATIENCE)


def test_a_frame_that_is_repeated_for_ever_does_not_close_it() -> None:
    assert not relay_that_heard(*[7] * 100).is_closed(5.0)
    assert not relay_that_heard(6, *[7] * 100).is_closed(5.0)


def test_a_counter_that_begins_again_is_one_that_moves() -> None:
    assert relay_that_heard(254, 255, 0).is_closed(0.1)


def test_frames_that_are_too_far_apart_do_not_close_it() -> None:
    assert not relay_that_heard(1, 2, 3, every=0.21).is_closed(0.42)


@pytest.mark.parametrize("frame", [FRAME.pack(1, 0)[:-1], bytes(8), FRAME.pack(1, 0)[::-1], b""])
def test_what_is_no_heartbeat_is_counted_and_does_not_close_it(frame: bytes) -> None:
    made = Relay(IDENTIFIER, PATIENCE)
    for _ in range(4):
        made.take(IDENTIFIER, frame, 0.0)
    assert made.garbled == 4
    assert not made.is_closed(0.0)


def test_frames_of_others_are_nothing_to_it() -> None:
    made = Relay(IDENTIFIER, PATIENCE)
    for counter in range(4):
        made.take(0x123, FRAME.pack(counter, 0), 0.0)
    assert (made.garbled, made.is_closed(0.0)) == (0, False)
