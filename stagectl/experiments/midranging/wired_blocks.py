"""The real pair as Blocks at the robot's 250 Hz: the stage behind its link, the robot behind its port."""

from dataclasses import dataclass, field

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.link.smoothed_line import SmoothedLine
from stagectl.link.stage_link import StageLink
from stagectl.robot.port import RobotPort
from stagectl.robot.tracker import TrackerLine
from stagectl.wire.messages import AXES


@dataclass(eq=False)
class LivePair:
    """Both ends, and what both Blocks share.

    Parameters
    ----------
    stage : StageLink
    robot : RobotPort, of mode "pose"
    axes : tuple of int
        Which of the stage's axes and of the base's, from 0.
    gain : float, 1/s
        Of the controller inside the stage's loop: an error into its control signal.
    tracker : TrackerLine or None
        Who sees the relative position beside the stage; None for the robot itself.
    """

    stage: StageLink
    robot: RobotPort
    axes: tuple[int, ...]
    gain: float
    tracker: TrackerLine | None = None
    start: np.ndarray = field(default_factory=lambda: np.zeros(7))
    seen_start: np.ndarray = field(default_factory=lambda: np.zeros(3))
    fast_reference: np.ndarray = field(default_factory=lambda: np.zeros(len(AXES)))

    def begin(self) -> None:
        """Take where the robot is, once it may follow, as zero."""
        self.start[:] = self.robot.sent
        self.seen_start[:] = self.start[:3] if self.tracker is None else self.tracker.inbox.pose[:3]
        self.fast_reference[:] = 0.0

    def rest(self) -> None:
        """Hold the robot where it is, and have the stage go to mid-travel; LinkError where that does not answer."""
        self.robot.stop()
        if not self.stage.reason:
            self.stage.stop()

    def refuse_when_latched(self) -> None:
        """Raise while a fault of either end is latched."""
        if self.stage.reason:
            self.stage.refuse_when_latched()
        if self.robot.reason:
            self.robot.refuse_when_latched()


class LiveSeen(Block):
    """What both show: `relative`, `fast`, `slow`, `position` (m) and `control` (m/s), one wide an axis, out.

    `fast` is the stage's position from mid-travel, `slow` the robot's own from where it began; `relative` and
    `position`, which are one here, the stage's and, by robot or tracker, the robot's.  `control` is what the stage's
    inner controller makes of the last reference, by its gain.

    Parameters
    ----------
    pair : LivePair
        While a fault of either end is latched, a tick raises it.
    """

    def __init__(self, pair: LivePair) -> None:
        width = len(pair.axes)
        self.outputs = (
            *(Port(name, "m", width) for name in ("relative", "fast", "slow")),
            Port("control", "m/s", width),
            Port("position", "m", width),
        )
        self.pair = pair
        _, self._stage = pair.stage.signal("position")

    def process(
        self, relative: np.ndarray, fast: np.ndarray, slow: np.ndarray, control: np.ndarray, position: np.ndarray
    ) -> None:
        """Fill one frame."""
        pair = self.pair
        pair.refuse_when_latched()
        report = pair.robot.report
        for place, axis in enumerate(pair.axes):
            fast[:, place] = self._stage[axis]
            slow[:, place] = np.nan if report is None else report.pose[axis] - pair.start[axis]
            if pair.tracker is None:
                relative[:, place] = slow[0, place]
            else:
                relative[:, place] = pair.tracker.inbox.pose[axis] - pair.seen_start[axis]
            control[:, place] = pair.gain * (pair.fast_reference[axis] - self._stage[axis])
        relative += fast
        position[:] = relative


class LiveSend(Block):
    """Where both manipulators are to be: `fast_reference` and `slow_reference` (m), one wide an axis, in.

    The stage gets its reference sample by sample behind a first-order low-pass, since a step of 4 ms would shake it;
    that low-pass is a part of the loop that mid-ranging sees.  The robot gets its start and the sum.

    Parameters
    ----------
    pair : LivePair
        While a fault of either end is latched, a tick raises it.
    smoothing : float, s, > 0
        Time constant of the low-pass.
    """

    def __init__(self, pair: LivePair, smoothing: float) -> None:
        self.inputs = Port("fast_reference", "m", len(pair.axes)), Port("slow_reference", "m", len(pair.axes))
        self.pair, self.smoothing = pair, smoothing

    def prepare(self, rate: float, frames: int) -> None:
        """Begin at mid-travel."""
        self._line, self._pose = SmoothedLine(self.smoothing), np.zeros(7)

    def process(self, fast_reference: np.ndarray, slow_reference: np.ndarray) -> None:
        """Hand over the newest sample."""
        pair = self.pair
        pair.refuse_when_latched()
        self._pose[:] = pair.start
        for place, axis in enumerate(pair.axes):
            pair.fast_reference[axis] = fast_reference[-1, place]
            self._pose[axis] += slow_reference[-1, place]
        pair.stage.references.put(self._line.to(pair.fast_reference))
        pair.robot.conversation.wanted.put(self._pose, self._pose)
