"""The tool's way from segment to segment and along them, as a block."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.experiments.feed import segment_move_kernel as kernel
from stagectl.planning.problem import Pocket
from stagectl.robot.milling.feed_force_kernel import CONTROLLING
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
        self._settings = np.zeros(kernel.SETTINGS)
        self._settings[:] = (
            pocket.G, task.depth + task.lift, task.travel, task.plunge, task.step, task.acceleration, task.pause,
            task.stationary, CONTROLLING, 1.0 / rate, task.cell,
        )  # fmt: skip
        self._state, self._places = np.zeros(kernel.CELLS), np.zeros((5, 3))
        middle = 0.5 * task.cell * np.array([pocket.cols, -pocket.rows, 0.0])
        middle[2] = task.depth + task.lift
        self._places[[kernel.FROM, kernel.TO, kernel.HOME]] = middle

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
        kernel.run(
            number, start, stop, lift, feed, resultant, phase, holding,
            place, direction, is_running, is_finished, is_resting, duration, force_deviation,
            self._state, self._places, self._settings,
        )  # fmt: skip

    @property
    def is_at_rest(self) -> bool:
        """Whether all is milled and the tool is away."""
        return bool(self._state[kernel.PHASE] == kernel.WAITING and self._state[kernel.NUMBER] == 0.0)

    @property
    def milling(self) -> float:
        """How long the segment in hand has been milled, s."""
        return float(self._state[kernel.TIME]) if self._state[kernel.PHASE] == kernel.MILLING else 0.0
