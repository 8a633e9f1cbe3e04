"""A planner for durations that are not sure: it plans exactly on what one segment says of all the others."""

import numpy as np

from stagectl.planning import strip_kernel
from stagectl.planning.caution import Caution
from stagectl.planning.exact import Optimum
from stagectl.planning.milling import Milled
from stagectl.planning.problem import Pocket
from stagectl.planning.rate_belief import RateBelief
from stagectl.planning.rate_scales import Scales
from stagectl.planning.strips import NO_WAY, Cut, Standing, costs


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
    scales : Scales, optional
        Of the prior of measured rates: estimated before each pocket from all that was milled.  The first pocket is
        then milled with `Caution`.

    Departs
    -------
    Not in the text, whose planners hold the rates of different strips for unrelated: what was not tried yet they take
    for as good as was believed, and try it.  Of Thompson sampling, the median and several degrees of optimism, the ones
    of `MEASURED` and `UNKNOWN` lost least (docs/planning.md).
    """

    def __init__(self, pocket: Pocket, belief: RateBelief, scales: Scales | None = None) -> None:
        self.belief, self.scales = belief, scales
        self._pocket, self._costs = pocket, costs(pocket)
        self._caution = None if scales is None else Caution(pocket, scales.lots)
        self._optimum: Optimum | None = None
        self._seen: list[tuple[int, float]] = []

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next."""
        if self.scales is not None and standing.way == NO_WAY:
            self._begin(self.scales)
        if self._caution is None:
            return self._planned().best(standing)[0]
        return self._caution.chosen(self._planned(), standing, self.belief)

    def learn(self, milled: Milled) -> None:
        """Take in the rate of a finished segment."""
        cells = strip_kernel.length(milled.cut.way, tuple(milled.standing.uncut))
        rate = (milled.duration - self._costs.begin) / cells
        if self._caution is not None:
            self._caution.learn(milled)
        if rate > 0.0:  # a segment shorter than its acceleration says nothing
            at = milled.cut.way, milled.cut.k - 1
            self._see(int(np.ravel_multi_index(at, self._costs.rate.shape)), rate)
            if self.scales is not None:
                excess = float(np.log(rate / self._costs.rate[at]))
                self.scales.take(milled.cut.name(self._pocket.G), milled.cut.side, excess)
        if self.scales is not None and milled.leaves().is_done:
            self.scales.keep()

    def _planned(self) -> Optimum:
        """Return the optimum at what is hoped for, or, with caution, at the medians."""
        if self._optimum is None:
            rate = self.belief.hoped_for().reshape(self._costs.rate.shape)
            if self._caution is not None:
                rate = self._caution.leaning(self.belief)
            self._optimum = Optimum(self._costs._replace(rate=rate))
        return self._optimum

    def _begin(self, scales: Scales) -> None:
        """Begin a pocket: with scales that were estimated again, and with caution in the first one alone."""
        if self._caution is not None and self._caution.spent > 0.0:
            self._caution = None
        self.belief = RateBelief(self._pocket, self._costs.rate, scales.prior())
        seen, self._seen = self._seen, []
        for which, rate in seen:
            self._see(which, rate)

    def _see(self, which: int, rate: float) -> None:
        self._seen.append((which, rate))
        self.belief.observe(which, rate)
        self._optimum = None
