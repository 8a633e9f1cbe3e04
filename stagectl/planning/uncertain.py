"""A planner for durations that are not sure: it plans exactly on what one segment says of all the others."""

import numpy as np

from stagectl.planning import strip_kernel
from stagectl.planning.exact import Optimum
from stagectl.planning.milling import Milled
from stagectl.planning.problem import Pocket
from stagectl.planning.rate_belief import RateBelief
from stagectl.planning.strips import Cut, Standing, costs


class UncertainPlanner:
    """Plans exactly on a belief of all rates, which every segment changes.

    A strip that was slow off the north says that others off the north will be, and a slot that was fast that the narrow
    strips of its feed may be: the planner need not try each.  Where little is known, it counts on somewhat less than
    the median, so that what may be fast is tried, and what cannot be is not.

    Parameters
    ----------
    pocket : Pocket
    belief : RateBelief
        `measured(pocket)`, or `unknown(pocket)` where it is to train itself.

    Departs
    -------
    Not in the text, whose planners hold the rates of different strips for unrelated: what was not tried yet they take
    for as good as was believed, and try it.  Of Thompson sampling, the median and several degrees of optimism, the ones
    of `MEASURED` and `UNKNOWN` lost least (docs/planning.md).
    """

    def __init__(self, pocket: Pocket, belief: RateBelief) -> None:
        self.belief = belief
        self._costs = costs(pocket)
        self._optimum: Optimum | None = None

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next."""
        if self._optimum is None:
            rate = self.belief.hoped_for().reshape(self._costs.rate.shape)
            self._optimum = Optimum(self._costs._replace(rate=rate))
        return self._optimum.best(standing)[0]

    def learn(self, milled: Milled) -> None:
        """Take in the rate of a finished segment."""
        cells = strip_kernel.length(milled.cut.way, tuple(milled.standing.uncut))
        rate = (milled.duration - self._costs.begin) / cells
        if rate > 0.0:  # a segment shorter than its acceleration says nothing
            which = np.ravel_multi_index((milled.cut.way, milled.cut.k - 1), self._costs.rate.shape)
            self.belief.observe(int(which), rate)
            self._optimum = None
