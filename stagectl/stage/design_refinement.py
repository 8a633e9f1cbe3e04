"""A design's weights refined between those it chose from: once, when a stage is calibrated."""

import numpy as np
from scipy.optimize import minimize

from stagectl.config import Outer
from stagectl.models import InnovationModel
from stagectl.stage.design import Candidate, Design, Search, only
from stagectl.stage.design_bounds import of_axis
from stagectl.stage.weights import Weights

LOOKS = 300
"""Loops that are tried."""
STEP = 0.5
"""First step, of the natural logarithm of each weight."""
LEAST_CAUTION, LEAST_DOUBT = 0.1, 1e-3
"""Weights of zero are refined from here."""
OVER = 10.0
"""Error that a bound exceeded by its own size counts as."""

NONE = 1e3
"""And one where there is no loop."""


def refined(found: Design, model: InnovationModel, outer: Outer, axis: int) -> Design:
    """Return a design that keeps the same bounds and leaves no more error, its weights between those of `design`.

    Bandwidth, drive and feedforward stay within what is asked for.

    Parameters
    ----------
    found : Design
        From `design`.
    model : InnovationModel
    outer : Outer
    axis : int, counted from 0

    Source
    ------
    Nelder and Mead, Computer Journal 7 (1965) 308.
    """
    search = Search(model, outer, axis)
    most = np.array([of_axis(outer.bandwidth, axis), of_axis(outer.drive, axis), np.inf, np.inf, outer.feedforward])
    tried: list[Candidate] = []

    def cost(logarithms: np.ndarray) -> float:
        bandwidth, drive, doubt, caution, feedforward = map(float, np.minimum(np.exp(logarithms), most))
        each = next(search.candidates(only(Weights(bandwidth, drive, 0.0, doubt, caution, feedforward))), None)
        if each is None:
            return NONE
        over = search.reached(each).over(outer, axis)
        if over <= 1.0:
            tried.append(each)
        return each.left + OVER * min(max(over - 1.0, 0.0), 1.0)

    begin = found.weights
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
    minimize(cost, start, method="Nelder-Mead", options={"maxfev": LOOKS, "initial_simplex": corners})
    best = min(tried, key=lambda each: each.left, default=None)
    return found if best is None or best.left >= found.left else search.design(best)
