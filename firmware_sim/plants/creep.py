"""Creep of a piezo stack after a step of its voltage: three laws, each as a sum of first-order terms."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import gamma, log

import numpy as np

SLOWEST, FASTEST = 1e-6, 1e4
"""1/s, of the terms that stand for a law of all time scales."""
A_DECADE = 2
"""Terms; the sum is that of a trapezoidal rule over the logarithm of the rate, which converges exponentially."""


@dataclass(frozen=True)
class Creep:
    """What creeps after a step of one: `direct` at once, and of each term `share` (1 - exp(-`rate` t)).

    Parameters
    ----------
    rate : array, shape (terms,), 1/s
    share : array, shape (terms,), 1
    direct : float, 1
    """

    rate: np.ndarray
    share: np.ndarray
    direct: float = 0.0

    def after(self, time: np.ndarray) -> np.ndarray:
        """Return what has crept so long after a step of one, same shape, 1.

        Parameters
        ----------
        time : array, any shape, s
        """
        grown = -np.expm1(-np.asarray(time)[..., None] * self.rate)
        return np.asarray(self.direct + grown @ self.share)


def logarithmic(a_decade: float, onset: float) -> Creep:
    """Return creep by `a_decade` log10(1 + t / `onset`) of the step.

    Parameters
    ----------
    a_decade : float, 1
    onset : float, s

    Source
    ------
    Jung and Gweon, Rev. Sci. Instrum. 71 (2000) 1896, for the law, here with 1 + so that it begins at zero; Frullani's
    integral, ln(1 + t / T) = int (1 - exp(-t s)) exp(-T s) / s ds, for its terms.
    """
    rate, width = _rates()
    return Creep(rate, a_decade / log(10) * width * np.exp(-onset * rate))


def power_law(at_a_second: float, order: float) -> Creep:
    """Return creep by `at_a_second` t^`order` of the step, t in s: that of a fractional dashpot.

    Parameters
    ----------
    at_a_second : float, 1
    order : float, 1, 0 < order < 1

    Source
    ------
    Mainardi, Fractional Calculus and Waves in Linear Viscoelasticity, 2010, sec. 3.1; its terms by the integral of
    (1 - exp(-t s)) s^(-order - 1) over s, which is t^order gamma(1 - order) / order.
    """
    rate, width = _rates()
    scale = at_a_second * order / gamma(1.0 - order)
    share = scale * width * rate**-order
    beyond = rate[-1] * np.exp(0.5 * width[-1])  # faster terms have come at once
    return Creep(rate, share, float(scale * beyond**-order / order))


def chain(times: Sequence[float], shares: Sequence[float]) -> Creep:
    """Return the creep of Kelvin-Voigt elements in series.

    Parameters
    ----------
    times : sequence of float, s
    shares : sequence of float, 1
        Of the step, by which each grows in the end.
    """
    return Creep(1.0 / np.array(times, float), np.array(shares, float))


def _rates() -> tuple[np.ndarray, np.ndarray]:
    """Return rates, 1/s, spread evenly over the logarithm, and how far each stands for, (terms,)."""
    decades = np.log10(FASTEST / SLOWEST)
    rate = np.geomspace(SLOWEST, FASTEST, round(A_DECADE * decades) + 1)
    return rate, np.full(len(rate), log(10) / A_DECADE)
