"""The tracker's samples as the simulated tracker sends them, and what is wrong with them."""

import numpy as np
import pytest

from firmware_sim.tracker import TrackerCamera, TrackerFaults
from stagectl.robot.config import Tracker
from stagectl.robot.tracker_inbox import TrackerInbox
from stagectl.wire.tracker import Sample, Sighting, pack_sample

POSE = np.array([0.5, 0.0, 0.7, 1.0, 0.0, 0.0, 0.0])
STEP = 1 / 440
QUIET = TrackerFaults(lost=0.0, swapped=0.0, unseen=0.0)


class Sight:
    """A tracker, an inbox and a clock; `look` lets so many seconds pass."""

    def __init__(self, faults: TrackerFaults = QUIET) -> None:
        self.pose, self.now, self.reasons = POSE.copy(), 0.0, list[str]()
        self.camera = TrackerCamera(lambda: {7: self.pose, 3: POSE + 1.0}, faults)
        self.inbox = TrackerInbox(Tracker(), self.reasons.append)
        self.look(0.1)
        self.inbox.begin(self.now)
        self.look(STEP)

    def look(self, seconds: float, late: float = 0.0, rubbish: bytes = b"") -> None:
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            self.inbox.take(self.camera.look(self.now - late) + rubbish, self.now)
            self.inbox.watch(self.now)


def test_a_frame_among_others_is_followed_within_the_noise() -> None:
    sight = Sight()
    seen = []
    for _ in range(440):
        sight.pose[0] += 1e-5
        sight.look(STEP)
        seen.append(sight.inbox.pose[:3] - sight.pose[:3])
    assert sight.reasons == []
    assert np.std(seen) == pytest.approx(60e-6, rel=0.1)
    assert sight.inbox.counts.jumped == 0


def test_lost_and_swapped_samples_are_counted_and_borne() -> None:
    sight = Sight(TrackerFaults(seed=4, lost=0.02, swapped=0.02, unseen=0.02))
    sight.look(4.0)
    counts = sight.inbox.counts
    assert sight.reasons == []
    assert min(counts.lost, counts.late, counts.unseen) > 10


@pytest.mark.parametrize("seconds", [0.1, 0.5, 5.0])
def test_blindness_is_a_fault_that_is_told_once(seconds: float) -> None:
    sight = Sight()
    held = sight.inbox.pose.copy()
    sight.camera.is_blind = True
    sight.look(0.045)
    assert sight.reasons == []
    sight.look(seconds - 0.045)
    assert len(sight.reasons) == 1
    assert sight.reasons[0].startswith("the tracker is blind for 0.05")
    assert sight.reasons[0].endswith("s, must be <= 0.05 s: 2 LEDs of frame 7 are seen, must be >= 3")
    np.testing.assert_array_equal(sight.inbox.pose, held)
    sight.camera.is_blind = False
    sight.look(0.1)
    assert len(sight.reasons) == 1
    sight.inbox.begin(sight.now)
    sight.look(0.2)
    assert len(sight.reasons) == 1


def test_a_tracker_that_says_nothing_is_blind_as_well() -> None:
    sight = Sight()
    sight.camera.is_mute = True
    sight.look(0.2)
    assert len(sight.reasons) == 1
    assert "the tracker is blind for" in sight.reasons[0]


def test_one_jump_is_left_out_and_one_that_stays_is_a_fault() -> None:
    sight = Sight()
    sight.camera.jump = {7: np.array([3e-3, 0.0, 0.0])}
    sight.look(STEP)
    assert sight.inbox.counts.jumped == 1
    assert abs(sight.inbox.pose[0] - POSE[0]) < 4e-4
    sight.camera.jump = {}
    sight.look(0.1)
    assert sight.reasons == []
    sight.camera.jump = {7: np.array([0.005, 0.0, 0.0])}
    sight.look(0.5)
    assert len(sight.reasons) == 1
    assert "frame 7 jumps by" in sight.reasons[0]
    assert abs(sight.inbox.pose[0] - POSE[0]) < 4e-4


def test_a_turn_that_cannot_be_is_a_jump_too() -> None:
    sight = Sight()
    sight.pose[3:] = np.cos(0.05), 0.0, 0.0, np.sin(0.05)
    sight.look(STEP)
    assert sight.inbox.counts.jumped == 1


def test_samples_that_were_long_on_their_way_are_left_out() -> None:
    sight = Sight()
    sight.look(0.03, late=0.06)
    assert sight.inbox.counts.stale == round(0.03 / STEP)
    sight.look(0.05, late=0.06)
    assert len(sight.reasons) == 1
    assert "a sample comes 0.06 s late" in sight.reasons[0]


def test_leds_that_do_not_fit_and_poses_that_are_none_are_left_out() -> None:
    sight = Sight()
    held, counter = sight.inbox.pose, 10_000
    for residual, pose in ((1e-3, POSE), (np.nan, POSE), (1e-4, np.full(7, np.nan)), (1e-4, 2 * POSE)):
        counter += 1
        sight.now += STEP
        sight.inbox.take(pack_sample(Sample(counter, sight.now, (Sighting(7, 3, residual, pose),))), sight.now)
    assert sight.inbox.counts.unseen == 4
    assert sight.inbox.pose is held


def test_rubbish_on_the_line_is_counted_and_borne() -> None:
    sight = Sight()
    sight.look(0.5, rubbish=b"\x00TRK1\xff\xff\xff\xff" + bytes(20))
    assert sight.reasons == []
    assert sight.inbox.garbled > 100


def test_not_watched_it_complains_of_nothing() -> None:
    sight = Sight()
    sight.inbox.end()
    sight.inbox.lose()
    sight.camera.is_mute = True
    sight.look(1.0)
    assert sight.reasons == []
    assert sight.inbox.counts.reconnected == 1
