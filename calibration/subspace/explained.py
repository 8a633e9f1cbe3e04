"""What further regressors tell of signals, beside those that are known: an F test each."""

from dataclasses import dataclass

import numpy as np

FORETOLD = 1e-8
"""Part of a signal's power below which what is known tells all of it: nothing is left that more could."""


@dataclass(frozen=True)
class Explained:
    """Of each signal.

    Parameters
    ----------
    share : array, shape (signals,), 0 to 1
        Of what is known not to tell.
    probability : array, shape (signals,), 0 to 1
        Of as much by chance.
    """

    share: np.ndarray
    probability: np.ndarray


def explained(known: np.ndarray, beside: np.ndarray, wanted: np.ndarray) -> Explained:
    """Compare what is left of signals without and with further regressors.

    Parameters
    ----------
    known, beside : arrays, shapes (samples, regressors), any unit
    wanted : array, shape (samples, signals), any unit
    """
    from scipy.special import fdtrc  # slow to import

    without, both = (left(part, wanted) for part in (known, np.concatenate([known, beside], axis=1)))
    is_open = without > FORETOLD * np.sum(wanted**2, axis=0)
    share = np.where(is_open, 1 - both / np.maximum(without, np.finfo(float).tiny), 0.0)
    freedom = len(wanted) - known.shape[1] - beside.shape[1]
    ratio = np.where(is_open, share / np.maximum(1 - share, 1e-12) * freedom / beside.shape[1], 0.0)
    return Explained(share, np.asarray(fdtrc(beside.shape[1], freedom, ratio)))


def left(known: np.ndarray, wanted: np.ndarray, own: slice = slice(None), fresh: slice = slice(None)) -> np.ndarray:
    """Return what regressors leave of signals: sums of squares, shape (signals,), any unit.

    Parameters
    ----------
    known : array, shape (samples, regressors), any unit
    wanted : array, shape (samples, signals), any unit
    own, fresh : slice, optional
        Rows that they are fitted to, and rows that are looked at.
    """
    fitted = np.linalg.lstsq(known[own], wanted[own], rcond=None)[0]
    squares: np.ndarray = np.sum((wanted[fresh] - known[fresh] @ fitted) ** 2, axis=0)
    return squares
