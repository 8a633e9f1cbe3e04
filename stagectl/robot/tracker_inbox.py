"""What is made of a tracker's samples: order, sight, jumps, and how long it has been blind."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stagectl.robot.config import Tracker
from stagectl.robot.lag import Lag
from stagectl.wire.makes import TRACKERS
from stagectl.wire.sequence import Sequence
from stagectl.wire.tracker import Sample, Sighting

_TURN_LEVER = 0.1
"""m, by which a turn counts as a way: about the distance of the LEDs from the frame's origin."""


@dataclass
class TrackerCounts:
    """What became of the tracker's samples.

    Parameters
    ----------
    received, lost, late, stale, unseen, jumped : int
        Lost: missing before the next one; late: after their turn, or twice; stale: on their way for too long; unseen:
        without enough LEDs, or with a bad fit; jumped: further off than the frame can have moved.
    reconnected : int
    """

    received: int = 0
    lost: int = 0
    late: int = 0
    stale: int = 0
    unseen: int = 0
    jumped: int = 0
    reconnected: int = 0


class TrackerInbox:
    """Follows one frame of space.  Fed by one thread, read by others.

    A pose is taken when it comes in order and in time, enough LEDs are seen and fit, and, from `begin` to `end`, the
    frame can have moved so far since the last one.  A jump is left out; one that stays is left out, too, until `begin`
    or `end` is called again, since a tracker that has taken one LED for another is steady about it.

    Parameters
    ----------
    tracker : Tracker
    tell : callable(reason)
        Told once when the frame has not been seen for `tracker.blind`, or when the line goes; only while watched.
    """

    def __init__(self, tracker: Tracker, tell: Callable[[str], None]) -> None:
        self.tracker = tracker
        self.counts = TrackerCounts()
        self.pose = np.full(7, np.nan)
        self.seen = -np.inf
        self.is_watched = self._is_strict = False
        self._packets, self._lag = TRACKERS[tracker.wire](), Lag()
        self._sequence = Sequence(self._packets.modulus)
        self._tell, self._stamp, self._why = tell, -np.inf, "nothing has come"

    @property
    def garbled(self) -> int:
        """Pieces of the stream that were no sample."""
        return self._packets.garbled

    def take(self, data: bytes, now: float) -> None:
        """Take bytes from the tracker."""
        for sample in self._packets.take(data):
            self.accept(sample, now)

    def accept(self, sample: Sample, now: float) -> None:
        """Take a sample that has come at `now` (s)."""
        counts = self.counts
        counts.received += 1
        missing = self._sequence.accept(sample.counter)
        lag = self._lag.take(sample.time, now)
        if missing < 0:
            counts.late += 1
            return
        counts.lost += missing
        if not lag <= self.tracker.lag:
            counts.stale += 1
            self._why = f"a sample comes {lag:.3g} s late"
            return
        found = next((each for each in sample.sightings if each.frame == self.tracker.frame), None)
        if found is None or not self._is_seen(found):
            counts.unseen += 1
            return
        self._follow(found.pose, sample.time, now)

    def watch(self, now: float) -> None:
        """Look how long it has been blind."""
        blind = now - self.seen
        if self.is_watched and not blind <= self.tracker.blind:
            self.is_watched = False
            self._tell(f"the tracker is blind for {blind:.3g} s, must be <= {self.tracker.blind:g} s: {self._why}")

    def lose(self) -> None:
        """Hear that the line is down."""
        self._forget("the line is down")
        self.counts.reconnected += 1

    def begin(self, now: float) -> None:
        """Be watched from now on, and take the next pose wherever it is."""
        self._stamp, self.seen, self.is_watched, self._is_strict = -np.inf, now, True, True

    def end(self) -> None:
        """Be watched no more, and take every pose again."""
        self.is_watched = self._is_strict = False

    def _is_seen(self, found: Sighting) -> bool:
        tracker = self.tracker
        if found.leds < tracker.leds:
            self._why = f"{found.leds} LEDs of frame {found.frame} are seen, must be >= {tracker.leds}"
        elif not (np.isfinite(found.pose).all() and abs(np.linalg.norm(found.pose[3:]) - 1) < 1e-3):
            self._why = f"the pose of frame {found.frame} is no pose"
        elif not found.residual <= tracker.residual:
            self._why = f"LEDs of frame {found.frame} fit to {1e3 * found.residual:.3g} mm"
        else:
            return True
        return False

    def _follow(self, pose: np.ndarray, stamp: float, now: float) -> None:
        tracker = self.tracker
        if self._is_strict and np.isfinite(self._stamp):
            way = np.linalg.norm(pose[:3] - self.pose[:3])
            turn = 2 * np.arccos(min(abs(float(pose[3:] @ self.pose[3:])), 1.0)) * _TURN_LEVER
            reach = tracker.jump + tracker.speed * min(stamp - self._stamp, tracker.blind)
            if not max(way, turn) <= reach:
                self.counts.jumped += 1
                self._why = f"frame {tracker.frame} jumps by {1e3 * max(way, turn):.3g} mm"
                return
        self.pose = pose  # a new array each time: a reader has the old or the new one
        self._stamp, self.seen = stamp, now

    def _forget(self, why: str) -> None:
        self._packets.forget()
        self._sequence.reset()
        self._lag.forget()
        self._stamp, self._why = -np.inf, why
