"""The tracker's samples as they come over its line, one by one for a graph that judges them."""

import time
from collections import deque
from collections.abc import Callable
from typing import Self

import numpy as np

from stagectl.link.bus import LinkError
from stagectl.link.robot_stream import Stream
from stagectl.robot.config import Tracker
from stagectl.robot.wired_tracker import SPINDLE
from stagectl.wire.makes import TRACKERS
from stagectl.wire.tracker import Sample

_KEPT = 4_096
"""Samples that wait for a reader that stands still; older ones are lost."""


class TrackerSamples:
    """The tracker behind its gateway: a context manager that reads all the time, and judges nothing.

    Parameters
    ----------
    tracker : Tracker
    now : callable() -> float, s, a monotonic clock
    patience : float, s

    Raises
    ------
    LinkError : on entry, when it does not show its two frames within `patience`.
    """

    def __init__(self, tracker: Tracker, now: Callable[[], float] = time.monotonic, patience: float = 2.0) -> None:
        self.behind = np.inf
        """s by which its clock is behind ours, by the sample that came quickest; begins anew with `skip`."""
        self._tracker, self._patience, self._packets = tracker, patience, TRACKERS[tracker.wire]()
        self._samples: deque[Sample] = deque(maxlen=_KEPT)
        self._shown: set[int] = set()
        self._stream = Stream(tracker.host, tracker.port, self, now)

    def __enter__(self) -> Self:
        """Connect, and wait until both frames are in what is sent."""
        self._stream.open()
        frames = {SPINDLE, self._tracker.frame}
        with self._stream.arrived:
            shown = self._stream.arrived.wait_for(lambda: frames <= self._shown, self._patience)
        if not shown:
            self._stream.close()
            missing = ", ".join(map(str, sorted(frames - self._shown)))
            where = f"{self._tracker.host}:{self._tracker.port}"
            raise LinkError(f"the tracker on {where} does not show frame {missing} within {self._patience:g} s")
        return self

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        self._stream.close()

    def skip(self) -> None:
        """Forget what waits, and how quickly samples came."""
        self._samples.clear()
        self.behind = np.inf

    def next(self, time: float) -> Sample | None:
        """Return the oldest sample that waits, or None where there is none, or it is stamped later than `time` (s)."""
        return self._samples.popleft() if self._samples and self._samples[0].time <= time else None

    def take(self, data: bytes, now: float) -> None:
        """Take bytes from the tracker."""
        for sample in self._packets.take(data):
            self.behind = min(self.behind, now - sample.time)
            self._shown.update(each.frame for each in sample.sightings)
            self._samples.append(sample)

    def watch(self, now: float) -> None:
        """Nothing hangs on its being there in time: who judges the samples does."""

    def lose(self) -> None:
        """Begin anew: the line was down."""
        self._packets.forget()
