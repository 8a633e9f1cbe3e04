"""Models of several horizons and orders, each held against blocks of the records that it was not identified from."""

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.linalg import LinAlgError

from calibration.subspace.estimate import Compressed, Estimate
from calibration.subspace.folds import Folds, Part
from calibration.subspace.gain_refinement import QUICK, refine_gain
from calibration.subspace.kalman_gain import Gain, is_stable
from calibration.subspace.order import standing_out
from calibration.subspace.predicted import estimated
from calibration.subspace.realization import Method, transition
from calibration.subspace.regression import Terms
from calibration.subspace.signals import Signals
from calibration.subspace.trial import Trial, smallest
from calibration.subspace.weighting import left_by_free_run
from calibration.subspace.windows import Layout

PARTS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
"""Of the order that stands out of the noise: what is tried first."""
STEPS = (-2, -1, 1, 2)
"""What is tried around the best."""
LARGEST = 30
"""Order up to which more is tried than what stands out of the noise."""
SAMPLES = 10
"""So many are wanted for each coefficient of a model."""
ROUNDS: tuple[tuple[int | None, ...], ...] = ((1,), (3,), (0, 2))
"""Folds on which what is left is judged, before it is thinned out."""
KEPT, FEWEST = 4, 4
"""One in so many is left after a round, and the best few of all and of those that stand out of the noise."""
ALIKE, SEEN = 0.01, 0.03
"""Part of its errors by which an order may be worse that is taken since it is smaller; the same on what was fitted."""


class Trials:
    """Tries horizons and orders on records.

    Free run and prediction one step ahead count alike, each by the log of its error: a tenth less of either is worth as
    much.  What does badly on the first folds is not tried on the others.  Where folds are not alike (a sweep excites
    each frequency once) nothing can be held out: then all is fitted, and judged, with less trust in larger orders.
    Where models may be unstable, inputs follow outputs, or there are none, the prediction counts alone.

    Parameters
    ----------
    data : Signals
    longest : Layout
        Of the horizons that will be tried.
    method : "n4sid" or "moesp"
    terms : Terms
    """

    def __init__(self, data: Signals, longest: Layout, method: Method, terms: Terms) -> None:
        self._method, self._terms = method, terms
        self._folds = Folds(data, longest, terms.constant)
        self._rounds, self._near = (ROUNDS, ALIKE) if self._folds.are_alike else (((None,),), SEEN)
        self._compressed: dict[tuple[int | None, Layout], Compressed] = {}
        self._limits: dict[Layout, int] = {}
        self.most = max(1, data.samples // (SAMPLES * (longest.inputs + 2 * longest.outputs)))
        self.done: list[Trial] = []

    def open(self, layout: Layout, order: int | None) -> list[Trial]:
        """Return what is to be tried at a horizon: the order given, or those that make sense."""
        if order is not None:
            return [Trial(layout, order, True)]
        limit = self._limit(layout)
        most = min(layout.largest_order, self.most)
        orders = sorted({min(most, max(1, round(part * limit))) for part in PARTS})
        return [Trial(layout, n, n <= limit) for n in orders if n <= max(LARGEST, limit)]

    def thin_out(self, trials: Iterable[Trial]) -> Trial:
        """Try them on more and more folds, the best of them alone; return the one to take."""
        left = list(trials)
        seen: list[int | None] = []
        for folds in self._rounds:
            for trial in left:
                for fold in folds:
                    self._judge(trial, fold)
            seen += folds
            self.done += [each for each in left if each not in self.done]
            ranked = sorted(left, key=lambda each: -each.score_on(seen))
            sure = [each for each in ranked if each.stands_out]
            best = [*ranked[: max(FEWEST, len(ranked) // KEPT)], *sure[:FEWEST]]
            left = [each for each in ranked if each in best]
        return smallest(left, self._near)

    def around(self, best: Trial, layouts: Sequence[Layout], order: int | None) -> list[Trial]:
        """Return the orders and the horizons next to one that were not tried."""
        place = layouts.index(best.layout)
        near = [(layout, best.order) for layout in layouts[max(0, place - 1) : place + 2]]
        if order is None:
            near += [(best.layout, best.order + step) for step in STEPS]
        tried = {(each.layout, each.order) for each in self.done}
        found = []
        for layout, wanted in near:
            if 1 <= wanted <= min(layout.largest_order, self.most) and (layout, wanted) not in tried:
                found.append(Trial(layout, wanted, wanted <= self._limit(layout)))
        return found

    def transition(self, trial: Trial) -> np.ndarray:
        """Return A of one that was tried, shape (n, n)."""
        projection = self._of(None, trial.layout).projection
        matrix, _ = transition(projection.observability(trial.order), trial.layout.outputs)
        return matrix

    def _limit(self, layout: Layout) -> int:
        """Return how many states stand out of the noise at a horizon, at least 1."""
        if layout not in self._limits:
            seen = self._of(None, layout)
            self._limits[layout] = max(1, standing_out(seen.triangle, layout, seen.windows))
        return self._limits[layout]

    def _of(self, fold: int | None, layout: Layout) -> Compressed:
        if (fold, layout) not in self._compressed:
            self._compressed[fold, layout] = self._folds.compressed(fold, layout, self._method)
        return self._compressed[fold, layout]

    def _judge(self, trial: Trial, fold: int | None) -> None:
        """Fit it to all other folds and hold it against one, unless that was done."""
        if fold in trial.free_run:
            return
        kept, held = self._folds.kept(fold), self._folds.held_out(fold)
        try:
            found = estimated(self._of(fold, trial.layout), trial.order, kept.drives, kept.responses, self._terms)
            model = found.model(_gain(found, kept))
        except (LinAlgError, ValueError):
            trial.free_run[fold] = trial.one_step[fold] = np.full(trial.layout.outputs, np.inf)
            return
        free, ahead = [], []
        for drive, measured in zip(held.drives, held.responses, strict=True):
            response = measured - found.constant
            start = model.initial_predictor_state(drive, response)
            ahead.append(response - model.predict(drive, response, start))
            if self._terms.stable and not self._terms.fed_back and trial.layout.inputs:
                free.append(response - model.simulate(drive, model.initial_state(drive, response)))
        trial.free_run[fold], trial.one_step[fold] = (
            np.mean(np.concatenate(each) ** 2, axis=0) for each in (free or ahead, ahead)
        )


def _gain(found: Estimate, kept: Part) -> Gain:
    """Return a gain that is nearly as good as it will be; that of an unstable model as it is."""
    if not is_stable(found.transition):
        return found.gain
    missed = left_by_free_run(found, kept.drives, kept.responses)
    return refine_gain(found.transition, found.outlet, found.gain, missed, QUICK)
