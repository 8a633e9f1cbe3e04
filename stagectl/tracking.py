"""How well a run followed: mean absolute error, standard deviation, peak, and what part was within bounds."""

from dataclasses import dataclass

import numpy as np

WITHIN = 5e-6
"""m: the control error of the thesis' runs is within this [Sörnmo 2015, sec. 2.5]."""


@dataclass(frozen=True)
class Tracking:
    """The error of one axis over a run, m.

    Parameters
    ----------
    mae, std, peak : float, m
        Mean absolute error (2.8), standard deviation, largest absolute error.
    within : float, 1
        Part of the samples within +-`WITHIN`.
    """

    mae: float
    std: float
    peak: float
    within: float


def tracking(error: np.ndarray) -> Tracking:
    """Return the measures of an error.

    Parameters
    ----------
    error : array, shape (samples,), m

    Source
    ------
    Sörnmo 2015, eq. (2.8).

    Examples
    --------
    >>> tracking(np.array([1e-6, -1e-6, 1e-6, -7e-6])).within
    0.75
    """
    size = np.abs(error)
    return Tracking(float(size.mean()), float(error.std()), float(size.max()), float((size <= WITHIN).mean()))
