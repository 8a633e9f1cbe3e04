"""The optical tracker: its line."""

import time
from collections.abc import Callable
from typing import Self

import numpy as np

from stagectl.link.bus import LinkError
from stagectl.link.robot_stream import Stream
from stagectl.robot.config import Tracker
from stagectl.robot.tracker_inbox import TrackerCounts, TrackerInbox


class TrackerLine:
    """The tracker behind its gateway: a context manager that reads all the time, and is watched from `start` to `stop`.

    Parameters
    ----------
    tracker : Tracker
    hold : callable(reason)
        Called once when it is blind for too long while it is watched, such as `RobotPort.hold`.
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    LinkError : on entry, when the frame is not seen within `patience`.
    """

    def __init__(
        self,
        tracker: Tracker,
        hold: Callable[[str], None],
        now: Callable[[], float] = time.monotonic,
        patience: float = 2.0,
    ) -> None:
        self.tracker, self.inbox = tracker, TrackerInbox(tracker, hold)
        self._now, self._patience = now, patience
        self._stream = Stream(tracker.host, tracker.port, self.inbox, now)

    def __enter__(self) -> Self:
        """Connect, and wait until the frame is seen."""
        self._stream.open()
        with self._stream.arrived:
            seen = self._stream.arrived.wait_for(lambda: self.inbox.seen > -np.inf, self._patience)
        if not seen:
            self._stream.close()
            host, port, frame = self.tracker.host, self.tracker.port, self.tracker.frame
            raise LinkError(f"the tracker on {host}:{port} does not show frame {frame} within {self._patience:g} s")
        return self

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        self.stop()
        self._stream.close()

    @property
    def counts(self) -> TrackerCounts:
        """What became of its samples."""
        return self.inbox.counts

    def start(self) -> None:
        """Be watched: from now on, being blind for too long holds the robot."""
        self.inbox.begin(self._now())

    def stop(self) -> None:
        """Be watched no more."""
        self.inbox.end()
