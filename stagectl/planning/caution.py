"""A limit on what a planner may lose against the default order by rates that turn out other than believed."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri, stdtrit

from stagectl.planning import strip_kernel
from stagectl.planning.exact import Optimum
from stagectl.planning.milling import Milled
from stagectl.planning.problem import Pocket
from stagectl.planning.rate_belief import RateBelief
from stagectl.planning.strips import NO_WAY, Cut, Standing, after, costs, is_lifted, legal, moving, untouched
from stagectl.planning.zigzag import ZigzagPlanner

LOSS = 0.01
"""Of the time of the default order: what a pocket may take more."""
SAFE = 0.95
"""Probability with which the difference is to be on the safe side."""

FIRST_OTHER, FIRST_ACROSS = 2, 4
"""The first way off another side than the default order's, and the first that feeds north or south."""
LEANING = 1e-3
"""Of a rate."""

Chooser = Callable[[Standing], Cut]


class Order(NamedTuple):
    """What an order of strips takes, as a function of the rates.

    Parameters
    ----------
    fixed : float, s
        Moves and accelerations.
    fed : array, shape (ways x tool,), cells
        Fed by each strip.
    """

    fixed: float
    fed: np.ndarray


class Caution:
    """Allows what is, with what is left of the pocket, not slower than the default order by more than `LOSS`.

    What was milled and what is planned are compared with the default order of the whole pocket; the difference is
    Gaussian to first order in the logarithms of the rates.  It must be below the limit with the probability `SAFE`.
    Where its scales were estimated from lots it is Student's, with as many degrees of freedom, and one for what was
    believed of the scales before: of four lots nobody knows how far rates may be off.

    Parameters
    ----------
    pocket : Pocket
    lots : int
        From which the scales of the belief were estimated; 0 where they were not.

    Source
    ------
    Wu, Shariff, Lattimore and Szepesvári 2016, Conservative bandits: an action is taken where a lower confidence bound
    of all that was earned keeps to a part of what the default action earns; else that is taken.
    """

    def __init__(self, pocket: Pocket, lots: int = 0) -> None:
        self.deviations = float(stdtrit(lots + 1.0, SAFE) if lots else ndtri(SAFE))
        self._costs, self._default = costs(pocket), ZigzagPlanner(pocket)
        self._whole = self._order(self._default.choose, untouched(pocket))
        self.spent = 0.0
        """s since the pocket was begun, in finished segments and the moves to them."""
        self._at = untouched(pocket)

    def leaning(self, belief: RateBelief) -> np.ndarray:
        """Return the medians, a little more off other sides than the default order's, shape (ways, tool), s per cell.

        Of orders that are believed to take equally long, one off that side is nearer to what is compared with.
        """
        rate = np.exp(belief.mean).reshape(self._costs.rate.shape)
        rate[FIRST_OTHER:] *= 1.0 + LEANING
        return np.asarray(rate)

    def chosen(self, optimum: Optimum, standing: Standing, belief: RateBelief) -> Cut:
        """Return the strip with which the optimum begins if that is safe, or that of the default order.

        Parameters
        ----------
        optimum : Optimum
            At the rates on which it is planned.
        standing : Standing
        belief : RateBelief
        """
        wanted, default = optimum.best(standing)[0], self._resumed(standing)
        if wanted == default:
            return default
        is_safe = self._is_safe(self._order(lambda at: optimum.best(at)[0], standing), belief)
        return wanted if is_safe else default

    def learn(self, milled: Milled) -> None:
        """Take in what a finished segment took."""
        self.spent += milled.duration + moving(milled.cut, milled.standing, self._costs)
        self._at = milled.leaves()

    def _resumed(self, standing: Standing) -> Cut:
        """Return the strip of the default order, resumed off its own side after feeds that it does not have."""
        if standing.way < FIRST_ACROSS:
            return self._default.choose(standing)
        return min(
            legal(standing, self._costs),
            key=lambda cut: (cut.way >= FIRST_OTHER, is_lifted(cut, standing), -cut.k, cut.way),
        )

    def _is_safe(self, order: Order, belief: RateBelief) -> bool:
        fixed, fed = self._whole
        rate, share = np.exp(belief.mean), 1.0 + LOSS
        slope = (order.fed - share * fed) * rate
        excess = self.spent + order.fixed - share * fixed + slope.sum()
        variance = float(slope @ belief.covariance @ slope)
        return bool(excess + self.deviations * np.sqrt(max(variance, 0.0)) <= 0.0)

    def _order(self, chooser: Chooser, standing: Standing) -> Order:
        """Return what all takes that is not in `spent`: the strip under way, if one is, and the rest of the pocket."""
        fixed, fed = 0.0, np.zeros(self._costs.rate.shape)
        for cut, at in (*self._under_way(standing), *_strips(chooser, standing)):
            fixed += moving(cut, at, self._costs) + self._costs.begin
            fed[cut.way, cut.k - 1] += strip_kernel.length(cut.way, tuple(at.uncut))
        return Order(fixed, fed.ravel())

    def _under_way(self, standing: Standing) -> Iterator[tuple[Cut, Standing]]:
        if standing.way != NO_WAY and self._at != standing:
            before, after_it = (strip_kernel.breadth(standing.way, tuple(each.uncut)) for each in (self._at, standing))
            yield Cut(standing.way, before - after_it), self._at


def _strips(chooser: Chooser, standing: Standing) -> Iterator[tuple[Cut, Standing]]:
    while not standing.is_done:
        cut = chooser(standing)
        yield cut, standing
        standing = after(cut, standing)
