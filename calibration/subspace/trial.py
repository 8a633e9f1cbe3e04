"""A horizon and an order that are tried, and which of several is taken."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np

from calibration.subspace.order import Candidate
from calibration.subspace.windows import Layout

SURE = 0.08
"""Part of its errors by which an order must be better that does not stand out of the noise.

Chance makes up to 0.07 of it where there are 500 samples."""
_LEAST = 1e-14
"""Power of an error, re the signal's, below which there is rounding alone."""


@dataclass(eq=False)
class Trial:
    """A horizon and an order while they are tried.

    Parameters
    ----------
    layout : Layout
    order : int
    stands_out : bool
        Whether so many states stand out of the noise at this horizon.
    free_run, one_step : dicts of arrays, each of shape (p,), 1
        By fold: mean square of what was left of it while it was held out.
    """

    layout: Layout
    order: int
    stands_out: bool
    free_run: dict[int | None, np.ndarray] = field(default_factory=dict)
    one_step: dict[int | None, np.ndarray] = field(default_factory=dict)

    @property
    def score(self) -> float:
        """Of all folds on which it was tried, see `score_on`."""
        return self.score_on(self.free_run)

    def score_on(self, folds: Collection[int | None]) -> float:
        """Return the mean over outputs of the log of both errors' root mean squares, turned round; -inf of a failure.

        Parameters
        ----------
        folds : collection of int or None
            On which it was tried.
        """
        powers = [np.mean([side[fold] for fold in folds], axis=0) for side in (self.free_run, self.one_step)]
        return -0.5 * float(sum(np.log(np.maximum(power, _LEAST)).mean() for power in powers))

    @property
    def candidate(self) -> Candidate:
        """It, as others read it."""
        free, ahead = (float(np.mean(list(side.values())) ** 0.5) for side in (self.free_run, self.one_step))
        return Candidate(self.order, 100 * (1 - free), 100 * (1 - ahead), self.layout.future)


def smallest(trials: Sequence[Trial], near: float) -> Trial:
    """Return the smallest order that is as good as the best, at the horizon where it is best.

    One that does not stand out of the noise must be better than all that do.
    """
    best, sure = max(trials, key=_by_score), [each for each in trials if each.stands_out]
    if sure and max(each.score for each in sure) >= best.score - SURE:
        best, trials = max(sure, key=_by_score), sure
    good = [each for each in trials if each.score >= best.score - near]
    order = min(each.order for each in good)
    return max((each for each in good if each.order == order), key=_by_score)


def _by_score(trial: Trial) -> float:
    return trial.score
