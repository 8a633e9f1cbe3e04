"""The tool's way from segment to segment and along them, as a block."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.experiments.feed import segment_move_kernel as kernel
from stagectl.planning.problem import Pocket
from stagectl.robot.milling.feed_record import CONTROLLING
from stagectl.robot.segment_config import SegmentTask


class SegmentMove(Block):
    """Move to where a segment starts, wait, mill along it at the feed that is asked for, and say how that was.

    Between strips the tool stays down and steps over, or is lifted, travels and plunges; those moves are position
    controlled.  At its end a segment has its length: the feed is braked before it.  No retreat passes its start.
    When there is no segment left, the tool goes up and over the middle.

    Ports: `number`, `start`, `stop` (cells, 2), `lift` of the planner, `feed` (m/s), `resultant` (N) and `phase` of
    the force control, `holding` (1: nothing moves) in; `place` (m, 3), where the tool is to be from the north-west
    corner of the pocket at the depth of the cut, `direction` (1, 2) of the feed, `is_running` (1 while milling),
    `is_finished` (1 in the sample in which a segment ends), `is_resting` (1 while
    it waits above the middle), `duration` (s) and `force_deviation` (N) of it, out.

    Parameters
    ----------
    task : SegmentTask
    pocket : Pocket
    """

    inputs = (
        Port("number"), Port("start", "cells", 2), Port("stop", "cells", 2), Port("lift"), Port("feed", "m/s"),
        Port("resultant", "N"), Port("phase"), Port("holding"),
    )  # fmt: skip
    outputs = (
        Port("place", "m", 3), Port("direction", "1", 2), Port("is_running"), Port("is_finished"), Port("is_resting"),
        Port("duration", "s"), Port("force_deviation", "N"),
    )  # fmt: skip

    def __init__(self, task: SegmentTask, pocket: Pocket) -> None:
        self.task, self.pocket = task, pocket

    def prepare(self, rate: float, frames: int) -> None:
        """Stand over the middle."""
        task, pocket = self.task, self.pocket
        self._move = move = np.zeros(1, kernel.MOVE)
        for name in ("travel", "plunge", "step", "acceleration", "pause", "stationary"):
            move[name] = getattr(task, name)
        move["wide"], move["lift"], move["side"] = pocket.G, task.depth + task.lift, task.cell
        move["controlling"], move["period"] = CONTROLLING, 1.0 / rate
        middle = 0.5 * task.cell * np.array([pocket.cols, -pocket.rows, 0.0])
        middle[2] = task.depth + task.lift
        move["begin"] = move["end"] = move["home"] = middle

    def process(
        self,
        number: np.ndarray,
        start: np.ndarray,
        stop: np.ndarray,
        lift: np.ndarray,
        feed: np.ndarray,
        resultant: np.ndarray,
        phase: np.ndarray,
        holding: np.ndarray,
        place: np.ndarray,
        direction: np.ndarray,
        is_running: np.ndarray,
        is_finished: np.ndarray,
        is_resting: np.ndarray,
        duration: np.ndarray,
        force_deviation: np.ndarray,
    ) -> None:
        """Move on for one frame."""
        seen = number, start, stop, lift, feed, resultant, phase, holding
        asked = place, direction, is_running, is_finished, is_resting, duration, force_deviation
        kernel.run(seen, asked, self._move)

    @property
    def is_at_rest(self) -> bool:
        """Whether all is milled and the tool is away."""
        return bool(self._move["phase"][0] == kernel.WAITING and self._move["number"][0] == 0.0)

    @property
    def milling(self) -> float:
        """How long the segment in hand has been milled, s."""
        return float(self._move["time"][0]) if self._move["phase"][0] == kernel.MILLING else 0.0
