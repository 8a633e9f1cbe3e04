"""A design's weights refined between those it chose from: once, when a stage is calibrated."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from calibration.state_space.model import InnovationModel
from stagectl.config import Outer
from stagectl.stage.allowed_gains import AllowedGains, configured, of_axis
from stagectl.stage.design import Candidate, Design, NoLoop, Search, chosen, only
from stagectl.stage.measured_response import MeasuredResponse
from stagectl.stage.weights import Weights

LOOKS = 300
"""Loops that are tried."""
STEP = 0.5
"""First step, of the natural logarithm of each weight."""
LEAST_CAUTION, LEAST_DOUBT = 0.01, 1e-3
"""Weights of zero are refined from here."""
LEAST_BANDWIDTH = 0.01
"""Hz, of the integral action: slower, it would take out no creep while anybody waits."""
NIL = 1e-6
"""Feedforward below which there is none."""
OVER = 10.0
"""Error that a bound exceeded by its own size counts as."""

NONE = 1e3
"""And one where there is no loop."""


def designed(
    model: InnovationModel,
    outer: Outer,
    axis: int,
    allowed: AllowedGains | None = None,
    measured: MeasuredResponse | None = None,
) -> Design:
    """Design the outer loop of an axis with weights between those of `design`, too, also where it finds none.

    Parameters
    ----------
    model : InnovationModel
    outer : Outer
    axis : int, counted from 0
    allowed : AllowedGains, optional
        Above `Outer.reach`, in place of those of `outer`.
    measured : MeasuredResponse, optional
        What the loop is held against as well.

    Raises
    ------
    NoLoop : no loop keeps the bounds.
    """
    allowed = configured(outer, axis, model.rate) if allowed is None else allowed
    search = Search(model, outer, axis, allowed, measured)
    try:
        found = chosen(search)
    except NoLoop as fault:
        near = None if fault.nearest is None else _within_bounds(fault.nearest.weights, search)
        if near is None:
            raise
        found = near
    return refined(found, search)


def refined(found: Design, search: Search) -> Design:
    """Return a design that keeps the same bounds and leaves no more error, its weights between those of `design`.

    Bandwidth, drive and feedforward stay within what is asked for.

    Parameters
    ----------
    found : Design
        From `design`.
    search : Search

    Source
    ------
    Nelder and Mead, Computer Journal 7 (1965) 308.
    """
    kept = []

    def cost(each: Candidate) -> float:
        over = search.reached(each).over(search.outer)
        if over <= 1.0:
            kept.append(each)
        return each.left + OVER * min(max(over - 1.0, 0.0), 1.0)

    _descend(search, found.weights, cost)
    best = min(kept, key=lambda each: each.left, default=None)
    return found if best is None or best.left >= found.left else search.design(best)


def _within_bounds(weights: Weights, search: Search) -> Design | None:
    """Return a design that keeps the bounds, from weights that do not; None where there is none near them."""
    kept = []

    def cost(each: Candidate) -> float:
        over = search.reached(each).over(search.outer)
        if over <= 1.0 and each.left <= search.useless:
            kept.append(each)
        return min(over, NONE) + OVER * max(each.left - search.useless, 0.0)

    _descend(search, weights, cost, lambda: bool(kept))
    return search.design(kept[0]) if kept else None


def _descend(
    search: Search,
    begin: Weights,
    cost: Callable[[Candidate], float],
    is_enough: Callable[[], bool] = lambda: False,
) -> None:
    """Look at loops of lower and lower cost, from weights on, until that is enough."""
    outer, axis = search.outer, search.axis
    most = np.array([of_axis(outer.bandwidth, axis), of_axis(outer.drive, axis), np.inf, np.inf, outer.feedforward])

    def at(logarithms: np.ndarray) -> float:
        bandwidth, drive, doubt, caution, feedforward = map(float, np.minimum(np.exp(logarithms), most))
        bandwidth = max(bandwidth, min(LEAST_BANDWIDTH, most[0]))
        weights = Weights(bandwidth, drive, 0.0, doubt, caution, feedforward if feedforward > NIL else 0.0, begin.notch)
        each = next(search.candidates(only(weights)), None)
        return NONE if each is None else cost(each)

    def look_on(_: np.ndarray) -> None:
        if is_enough():
            raise StopIteration

    start = np.log(
        [
            begin.bandwidth,
            begin.drive,
            max(begin.doubt, LEAST_DOUBT),
            max(begin.caution, LEAST_CAUTION),
            max(begin.feedforward, np.finfo(float).tiny),
        ]
    )
    corners = start + np.vstack([np.zeros(len(start)), -STEP * np.eye(len(start))])
    minimize(at, start, method="Nelder-Mead", callback=look_on, options={"maxfev": LOOKS, "initial_simplex": corners})
