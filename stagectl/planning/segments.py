"""The planner as a block: a finished segment goes in, the next one comes out."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ctlblocks import Block, Port
from stagectl.planning import strip_kernel
from stagectl.planning.milling import Milled, Planner, finished
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Costs, costs, untouched


class Segments(Block):
    """Say which segment is to be milled, and plan the next one when it is finished.

    `process` holds what is to be milled and takes note of a finished segment; `advance`, called between ticks, tells
    the planner of it and asks for the next.  Planning takes from 0.1 to 200 ms, which no tick has: where the graph is
    in real time, the planner is a `PlannerBeside`.

    Ports
    -----
    is_finished : 1 in the sample in which a segment ended, else 0
    duration : s, of that segment, acceleration included
    force_deviation : N, standard deviation of the force within it; NaN where none was measured
    number : of the segment, from 1; 0 when all pockets are milled
    start, stop : row and column of the footprint, cells, where it begins and ends
    lift : 1 where the tool is lifted to get there
    cut : way and width of the strip, as a `Cut` has them

    Parameters
    ----------
    pocket : Pocket
    make : callable() -> Planner
        Called when the block is prepared.
    pockets : int
        How many to mill, one after the other.
    """

    inputs = (Port("is_finished"), Port("duration", "s"), Port("force_deviation", "N"))
    outputs = (Port("number"), Port("start", "cells", 2), Port("stop", "cells", 2), Port("lift"), Port("cut", "1", 2))

    def __init__(self, pocket: Pocket, make: Callable[[], Planner], pockets: int = 1) -> None:
        if not pockets >= 1:
            raise ValueError(f"pockets is {pockets}, must be >= 1")
        self.pocket, self.make, self.pockets = pocket, make, pockets
        self.done: list[Milled] = []
        """Finished segments."""
        self.missed = 0
        """Segments that ended before the one before them was told to the planner."""
        self._costs: Costs = costs(pocket)

    def prepare(self, rate: float, frames: int) -> None:
        """Make the planner and ask it for the first segment."""
        self.planner = self.make()
        self.done, self.missed, self._left = [], 0, self.pockets
        self._is_finished, self._measured = False, (0.0, 0.0)
        self._standing = untouched(self.pocket)
        self._values = np.zeros(8)  # number, start, stop, lift, cut
        self._ask()

    def process(
        self,
        is_finished: np.ndarray,
        duration: np.ndarray,
        force_deviation: np.ndarray,
        number: np.ndarray,
        start: np.ndarray,
        stop: np.ndarray,
        lift: np.ndarray,
        cut: np.ndarray,
    ) -> None:
        """Hold the segment and take note of its end."""
        at = int(is_finished.argmax())
        if is_finished[at, 0] > 0.5:
            self.missed += self._is_finished
            if not self._is_finished:
                self._is_finished = True
                self._measured = float(duration[at, 0]), float(force_deviation[at, 0])
        number[:] = self._values[0]
        start[:] = self._values[1:3]
        stop[:] = self._values[3:5]
        lift[:] = self._values[5]
        cut[:] = self._values[6:]

    def advance(self) -> None:
        """Learn from the segment that was finished, if one was, and choose the next.

        Raises
        ------
        ValueError : its duration is no number, or not longer than the acceleration; the segment stands as it was.
        """
        if not self._is_finished or self._left == 0:
            return
        duration, force = self._measured
        self._is_finished = False
        if not (self.pocket.t_acc < duration < math.inf):
            raise ValueError(f"segment {len(self.done) + 1}: duration is {duration} s, must be > {self.pocket.t_acc} s")
        milled = replace(self._next, duration=duration, force_deviation=force)
        self.planner.learn(milled)
        self.done.append(milled)
        self._standing = milled.leaves()
        if self._standing.is_done:
            self._left -= 1
            self._standing = untouched(self.pocket)
        if self._left:
            self._ask()
        else:
            self._values[:] = 0.0

    @property
    def name(self) -> str:
        """The type of the segment that is to be milled, or nothing."""
        return self._next.name if self._left else ""

    def _ask(self) -> None:
        cut = self.planner.choose(self._standing)
        self._next = finished(cut, self._standing, self._costs)
        row, col = strip_kernel.stop(cut.way, tuple(self._next.leaves().uncut), self._costs.pocket)
        end = (row, self._next.col) if cut.feed in "NS" else (self._next.row, col)
        self._values[:] = len(self.done) + 1, self._next.row, self._next.col, *end, self._next.is_lifted, *cut
