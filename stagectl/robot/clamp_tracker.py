"""What an optical tracker sees of every link at once, for a procedure that is not steered by it."""

import time
from collections.abc import Callable
from typing import Self

import numpy as np

from stagectl.link.bus import LinkError
from stagectl.link.robot_stream import Stream
from stagectl.robot.config import Tracker
from stagectl.wire.makes import TRACKERS
from stagectl.wire.sequence import Sequence
from stagectl.wire.tracker import Sample

FRAMES = 8
"""Base, links 1 to 6 and tool, by their number on the wire."""


class TrackedLinks:
    """The tracker's newest sight of base, links and tool: a context manager that reads all the time.

    A frame that is not seen well (LEDs, fit, age: as in `Tracker`) has a pose of zeros, its quaternion as well: nothing
    waits for it, and no one takes it for a place.

    Parameters
    ----------
    tracker : Tracker
    now : callable() -> float, s, a monotonic clock
    patience : float, s for a first sample

    Raises
    ------
    LinkError : on entry, when nothing comes within `patience`.
    """

    def __init__(self, tracker: Tracker, now: Callable[[], float] = time.monotonic, patience: float = 2.0) -> None:
        self.poses = np.zeros((FRAMES, 7))
        self.received = 0
        self._tracker, self._patience = tracker, patience
        self._packets, self._heard = TRACKERS[tracker.wire](), -np.inf
        self._sequence = Sequence(self._packets.modulus)
        self._stream = Stream(tracker.host, tracker.port, self, now)

    def __enter__(self) -> Self:
        """Connect, and wait for a first sample."""
        self._stream.open()
        with self._stream.arrived:
            heard = self._stream.arrived.wait_for(lambda: self.received > 0, self._patience)
        if not heard:
            self._stream.close()
            where = f"{self._tracker.host}:{self._tracker.port}"
            raise LinkError(
                f"the tracker on {where} has sent nothing within {self._patience:g} s; or set clamping.track=false"
            )
        return self

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        self._stream.close()

    def take(self, data: bytes, now: float) -> None:
        """Take bytes from the tracker."""
        for sample in self._packets.take(data):
            if self._sequence.accept(sample.counter) >= 0:
                self.poses = self._seen(sample)  # a new array each time: a reader has the old or the new one
                self.received += 1
                self._heard = now

    def watch(self, now: float) -> None:
        """Forget what was seen too long ago."""
        if not now - self._heard <= self._tracker.blind:
            self.poses = np.zeros((FRAMES, 7))

    def lose(self) -> None:
        """Begin anew: the line was down."""
        self._packets.forget()
        self._sequence.reset()
        self.poses = np.zeros((FRAMES, 7))

    def _seen(self, sample: Sample) -> np.ndarray:
        poses = np.zeros((FRAMES, 7))
        for each in sample.sightings:
            fits = each.leds >= self._tracker.leds and each.residual <= self._tracker.residual
            if each.frame < FRAMES and fits and np.isfinite(each.pose).all():
                poses[each.frame] = each.pose
        return poses
