"""The optimum of a pocket whose durations are known, from its beginning or from any state on the way."""

import numpy as np

from stagectl.planning import exact_kernel as kernel
from stagectl.planning.milling import Milled, learned
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Costs, Cut, Standing, costs, untouched

MOST_STATES = 50_000_000
"""400 MB of times; 40 x 40 cells in four directions are 5.4 million."""


class Optimum:
    """The least time to the end of a pocket, from every state.

    Two directions have 2 N (N + 1) states (N rows; side and end where the tool stands), four have R (R + 1) / 2 times
    C (C + 1) / 2 times 8 (side and feed that were last).

    Parameters
    ----------
    cost : Costs

    Raises
    ------
    ValueError : the pocket has more than `MOST_STATES` states.

    Departs
    -------
    The text verifies its planners by brute force, in "several hours"; dynamic programming is as exact, since the time
    still to be spent depends on nothing but the uncut rectangle and where the tool stands.
    """

    def __init__(self, cost: Costs) -> None:
        rows, cols, ways = (int(cost.pocket[name][0]) for name in ("rows", "cols", "ways"))
        rectangles = kernel.intervals(rows) * (kernel.intervals(cols) if ways == 8 else 1)
        if not rectangles * ways <= MOST_STATES:
            raise ValueError(f"{rows} x {cols} cells have {rectangles * ways} states, must be <= {MOST_STATES}")
        self.cost = cost
        self._togo = np.empty((rectangles, ways))
        kernel.fill(*cost, self._togo)

    def best(self, standing: Standing) -> tuple[Cut, float]:
        """Return the strip to mill next and the time from now to the end, s."""
        time, way, k = kernel.best(standing.way, tuple(standing.uncut), *self.cost, self._togo)
        return Cut(way, k), time


class ExactPlanner:
    """Plans exactly on the newest duration of each strip, and again when one differs.

    Parameters
    ----------
    pocket : Pocket
        What is believed in the beginning.
    """

    def __init__(self, pocket: Pocket) -> None:
        self._belief = costs(pocket)
        self._optimum = Optimum(self._belief)

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next."""
        return self._optimum.best(standing)[0]

    def learn(self, milled: Milled) -> None:
        """Take a finished segment's duration for that of its strip from now on."""
        newer = learned(self._belief, milled)
        if newer is not self._belief:
            self._belief, self._optimum = newer, Optimum(newer)


def least_time(pocket: Pocket) -> float:
    """Return the least time in which a pocket can be milled at what is really paid, s."""
    return Optimum(costs(pocket.paid())).best(untouched(pocket))[1]
