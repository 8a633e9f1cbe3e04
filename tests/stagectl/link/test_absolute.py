"""What the stage's lasers see, as it comes to the host: beside the positions of its block, whatever is lost."""

import numpy as np
import pytest

from firmware_sim.stage_frames import StageFrames
from stagectl.link.account import Lasers
from stagectl.link.config import Link
from stagectl.link.conversation import Conversation
from stagectl.link.inbox import Inbox
from stagectl.wire import messages
from stagectl.wire.messages import Fault, State


def block(number: int, frames: StageFrames) -> list[tuple[int, bytes]]:
    """Return a block's frames: positions are its number in um, lasers see 400 um more."""
    position = np.full((10, 3), 1e-6 * number)
    signals = {"position": position, "extension": position, "voltage": position, "absolute": position + 4e-4}
    frames.publish(number, signals)
    return [(frame.identifier, frame.data) for frame in frames.take()]


def seen(lost: dict[int, int]) -> tuple[np.ndarray, Inbox]:
    """Return what is beside each position (m) after 20 blocks, of which some have lost a frame."""
    inbox, frames = Inbox("fd"), StageFrames("fd", 0, 0.0)
    for number in range(20):
        for identifier, data in block(number, frames):
            if lost.get(number) != identifier:
                inbox.take(identifier, data, 0.0)
    position, absolute = np.zeros((2, 200, 3))
    assert inbox.rings["position"].take(position) == inbox.rings["absolute"].take(absolute) == 200
    return absolute - position, inbox


def test_lasers_and_positions_of_a_block_stay_together() -> None:
    off, inbox = seen({})
    np.testing.assert_allclose(off, 4e-4, atol=3e-8)
    assert inbox.counts.lasers.lost == 0


def test_a_block_that_is_lost_is_held_and_counted_and_those_after_it_stay_in_step() -> None:
    off, inbox = seen({5: messages.ABSOLUTE.identifier, 9: messages.POSITION.identifier})
    np.testing.assert_allclose(np.delete(off, slice(50, 60), axis=0), 4e-4, atol=3e-8)
    np.testing.assert_allclose(off[50:60], 3.99e-4, atol=3e-8)
    assert (inbox.counts.lasers.lost, inbox.counts.lost) == (1, 1)


def test_a_host_of_before_knows_no_such_identifier_and_passes_it_over() -> None:
    before = {0x010, 0x011, 0x020, 0x021, *range(0x100, 0x106), 0x110, *range(0x120, 0x124), 0x200, 0x201, 0x210, 0x211}
    new = {layout.identifier for layout in messages.LAYOUTS} - before
    assert new == {messages.ABSOLUTE.identifier, messages.LASER_STATUS.identifier, messages.SLOW_ABSOLUTE.identifier}


def test_nothing_of_lasers_is_sent_while_an_axis_is_excited() -> None:
    frames = StageFrames("fd", 0, 0.0)
    frames.shows_all = True
    assert messages.ABSOLUTE.identifier not in [identifier for identifier, _ in block(0, frames)]


@pytest.mark.parametrize("fault", [Fault.LASER_STALE, Fault.LASER_STUCK, Fault.LASER_IMPOSSIBLE])
def test_a_fault_of_a_laser_is_named_with_its_axis(fault: Fault) -> None:
    told: list[dict[str, object]] = []
    talk = Conversation(Link(), lambda _, fields: told.append(dict(fields)), 0.0)
    talk.begin()
    assert talk.inbox.counts.lasers == Lasers()
    talk.take(messages.LASER_STATUS.identifier, messages.LASER_STATUS.pack(0, 16, 3, 2, 0), 0.0)
    beat = messages.STAGE_HEARTBEAT.pack(0, State.RAMPING, fault, 0)
    talk.take(messages.STAGE_HEARTBEAT.identifier, beat, 0.0)
    talk.watch(0.0)
    assert told == [{"reason": f"the stage reports {fault.name}, the laser on y"}]
    assert talk.inbox.counts.lasers == Lasers(age=pytest.approx(1.6e-3), held=3, axis=2)
