"""Horizon and order together, by what models of each leave of blocks of the records that were held out in turn."""

import math
from dataclasses import dataclass

from calibration.subspace.horizons import affordable, given, longer, usual
from calibration.subspace.order import Candidate
from calibration.subspace.realization import Method
from calibration.subspace.regression import Terms
from calibration.subspace.signals import Signals
from calibration.subspace.trials import ALIKE, Trials
from calibration.subspace.windows import Layout
from calibration.warned import warn

HORIZONS = (5, 10, 15, 20, 30, 40, 60)
"""Samples, past and future, as far as records allow."""


@dataclass(frozen=True)
class Choice:
    """A horizon and an order.

    Parameters
    ----------
    layout : Layout
    order : int
    candidates : tuple of Candidate
        All that were tried, by rising order and horizon; none where nothing was.
    score : float
        Of the one that was chosen, see `Trial.score`; not a number where it was not tried.
    """

    layout: Layout
    order: int
    candidates: tuple[Candidate, ...] = ()
    score: float = math.nan


def choose(
    data: Signals,
    horizon: int | tuple[int, int] | None,
    order: int | None,
    method: Method,
    terms: Terms,
    is_compared: bool = False,
) -> Choice:
    """Choose what was not given of horizon and order.

    Parameters
    ----------
    data : Signals
    horizon : int or (past, future), samples, optional
    order : int, optional
    method : "n4sid" or "moesp"
    terms : Terms
    is_compared : bool, optional
        Try what was chosen even where both were given, for its score.

    Raises
    ------
    ValueError : records that are too short, an order or a horizon that they do not allow.
    """
    layouts = horizons(data, order) if horizon is None else [given(data, horizon, order)]
    if horizon is not None and order is not None and not is_compared:
        return Choice(layouts[0], order)
    trials = Trials(data, layouts[-1], method, terms)
    best = trials.thin_out([each for layout in layouts[::2] for each in trials.open(layout, order)])
    while near := trials.around(best, layouts, order):
        further = trials.thin_out([best, *near])
        if further is best:
            break
        best = further
    done = trials.done
    while horizon is None and (layout := longer(best.layout, data, trials.transition(best))) is not None:
        trials = Trials(data, layout, method, terms)
        again = trials.thin_out(trials.open(layout, order))
        done = done + trials.done
        if again.score < best.score - ALIKE:
            break
        best = again
    if order is None and 2 * best.order >= trials.most:
        warn(f"{data.samples} samples are few: orders beyond {trials.most} were not tried")
    told = [each.candidate for each in done if math.isfinite(each.score)]
    return Choice(best.layout, best.order, tuple(sorted(told, key=lambda each: (each.order, each.horizon))), best.score)


def horizons(data: Signals, order: int | None) -> list[Layout]:
    """Return the horizons to be tried: that the records allow, and that can tell the order if that is given."""
    able = [given(data, horizon, None) for horizon in HORIZONS if horizon <= affordable(data)]
    if order is not None:
        able = [each for each in able if order <= each.largest_order]
    return able or [usual(data, order)]
