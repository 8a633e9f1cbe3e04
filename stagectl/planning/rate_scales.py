"""The scales of the prior of rates, estimated from what was milled: empirical Bayes."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from stagectl.planning.rate_belief import Prior, shared_covariance
from stagectl.planning.rate_lots import Lot, read_lots, write_lots

LEARNED = ("common", "side", "feed", "type", "own", "noise")
"""Scales that are estimated."""
WIDTH = 1.0
"""Standard deviation of the logarithm of a scale before anything was milled: a factor of e either way."""
LEAST, MOST = 2e-3, 2.0
"""Of a scale."""
MOST_LOTS = 30
"""That a file keeps, the newest."""


class Scales:
    """The scales of a prior, and what they are estimated from: lots that were milled, the last one still growing.

    Parameters
    ----------
    before : Prior
        What holds where nothing was milled.
    file : Path, optional
        Keeps the lots from one use to the next; made where there is none.

    Raises
    ------
    ValueError, OSError : the file is no such file, or cannot be read.
    """

    def __init__(self, before: Prior, file: Path | None = None) -> None:
        self._before, self._file, self._own = before, file, Lot()
        self._lots = read_lots(file) if file is not None and file.exists() else []

    @property
    def lots(self) -> int:
        """How many lots of others the file had, which tell the scales as the first pocket begins."""
        return len(self._lots)

    def take(self, name: str, side: str, excess: float) -> None:
        """Take in a segment: as of `Lot.add`."""
        self._own.add(name, side, excess)

    def prior(self) -> Prior:
        """Return the prior by all that was milled."""
        return estimated([*self._lots, self._own], self._before)

    def keep(self) -> None:
        """Write the newest `MOST_LOTS` lots to the file, if there is one."""
        if self._file is not None:
            write_lots(self._file, [*self._lots, self._own][-MOST_LOTS:], self.prior())


def estimated(lots: Sequence[Lot], before: Prior) -> Prior:
    """Return the prior whose scales are the likeliest after lots were milled; `before` where none was.

    Parameters
    ----------
    lots : sequence of Lot
        Each is a draw of its own from the prior.
    before : Prior
        Its scales are the medians of log-normal distributions of `WIDTH`.

    Source
    ------
    Type II maximum likelihood with a prior on the hyperparameters: Rasmussen and Williams 2006, Gaussian Processes for
    Machine Learning, sec. 5.4.1, eq. (5.8).
    """
    made = [_Sums(lot) for lot in lots if lot.sums]
    if not made:
        return before
    median = np.log([max(getattr(before, name), LEAST) for name in LEARNED])

    def loss(scales: np.ndarray) -> float:
        prior = _with(before, scales)
        return float(0.5 * (((scales - median) / WIDTH) ** 2).sum()) + sum(each.loss(prior) for each in made)

    found = minimize(loss, median, method="L-BFGS-B", bounds=[(math.log(LEAST), math.log(MOST))] * len(LEARNED))
    return _with(before, found.x)


def _with(prior: Prior, scales: Iterable[float]) -> Prior:
    return replace(prior, **{name: float(np.exp(each)) for name, each in zip(LEARNED, scales, strict=True)})


class _Sums:
    """A lot as arrays."""

    def __init__(self, lot: Lot) -> None:
        names, sides = zip(*lot.sums, strict=True)
        self._names, self._sides = np.array(names), np.array(sides)
        self._count, total, squares = np.array(list(lot.sums.values())).T
        self._mean = total / self._count
        self._within = float((squares - total * self._mean).sum())

    def loss(self, prior: Prior) -> float:
        """Return minus the logarithm of the marginal likelihood, but for a constant."""
        variance = prior.noise**2
        covariance = shared_covariance(self._names, self._sides, prior) + np.diag(variance / self._count)
        factor = np.linalg.cholesky(covariance)
        white = np.linalg.solve(factor, self._mean)
        repeats = self._count.sum() - len(self._count)
        return float(
            np.log(factor.diagonal()).sum()
            + 0.5 * (white @ white)
            + 0.5 * (repeats * math.log(variance) + self._within / variance)
        )
