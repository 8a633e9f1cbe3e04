"""The tracker within a graph: its samples judged as those over TCP are, for spindle and workpiece, in graph time."""

from collections.abc import Callable

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.config import Tracker
from stagectl.robot.tracker_inbox import TrackerCounts, TrackerInbox
from stagectl.wire.tracker import Sample, Sighting

SPINDLE = 0
"""Number of the spindle's frame; the workpiece's is `tracker.frame`."""


class WiredTracker(Block):
    """Follow spindle and workpiece, and hold the robot when either is not seen for `tracker.blind`.

    Ports: of the tracker `sample` (1), its counter, `stamp` (s), `spindle` and `workpiece` (1, 7: m and w x y z),
    `leds` and `residual` (1 and m, 2) in; `spindle_position`, `workpiece_position` (m, 3), `workpiece_orientation`
    (1, 4) of the newest samples that can be, and the older one's `age` (s) out; zero until both have been seen.

    Parameters
    ----------
    tracker : Tracker
    hold : callable(reason)
        Such as `WiredPort.hold`.
    """

    inputs = (
        Port("sample"), Port("stamp", "s"), Port("spindle", "1", 7), Port("workpiece", "1", 7), Port("leds", "1", 2),
        Port("residual", "m", 2),
    )  # fmt: skip
    outputs = (
        Port("spindle_position", "m", 3), Port("workpiece_position", "m", 3), Port("workpiece_orientation", "1", 4),
        Port("age", "s"),
    )  # fmt: skip

    def __init__(self, tracker: Tracker, hold: Callable[[str], None]) -> None:
        self._trackers = tracker.model_copy(update={"frame": SPINDLE}), tracker
        self._hold = hold

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen."""
        self._inboxes = [TrackerInbox(tracker, self._hold) for tracker in self._trackers]
        self._rate, self._done, self._seen = rate, 0, 0.0
        self._where = np.zeros((2, 7))

    def process(
        self,
        sample: np.ndarray,
        stamp: np.ndarray,
        spindle: np.ndarray,
        workpiece: np.ndarray,
        leds: np.ndarray,
        residual: np.ndarray,
        spindle_position: np.ndarray,
        workpiece_position: np.ndarray,
        workpiece_orientation: np.ndarray,
        age: np.ndarray,
    ) -> None:
        """Judge, sample by sample."""
        for n in range(len(sample)):
            self._done += 1
            now = self._done / self._rate
            if sample[n, 0] > self._seen:
                self._seen = float(sample[n, 0])
                self._take(float(stamp[n, 0]), (spindle[n], workpiece[n]), leds[n], residual[n], now)
            for inbox in self._inboxes:
                if inbox.is_watched:
                    inbox.watch(now)
            since = max(0.0, min(inbox.seen for inbox in self._inboxes))
            spindle_position[n], workpiece_position[n] = self._where[0, :3], self._where[1, :3]
            workpiece_orientation[n], age[n, 0] = self._where[1, 3:], now - since

    def start(self) -> None:
        """Be watched from now on (between ticks)."""
        for inbox in self._inboxes:
            inbox.begin(self._done / self._rate)

    @property
    def counts(self) -> tuple[TrackerCounts, TrackerCounts]:
        """What became of the samples, of spindle and workpiece."""
        return self._inboxes[0].counts, self._inboxes[1].counts

    def _take(
        self, stamp: float, poses: tuple[np.ndarray, np.ndarray], leds: np.ndarray, residual: np.ndarray, now: float
    ) -> None:
        for n, inbox in enumerate(self._inboxes):
            seen = Sighting(inbox.tracker.frame, int(leds[n]), float(residual[n]), poses[n].copy())
            inbox.accept(Sample(int(self._seen), stamp, (seen,)), now)
            if np.isfinite(inbox.seen):
                self._where[n] = inbox.pose
