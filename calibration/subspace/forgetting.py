"""Predictors that forget where they began within the length of a record."""

import numpy as np
from scipy.linalg import LinAlgError

from calibration.subspace.kalman_gain import is_stable
from calibration.subspace.riccati import filter_covariance

LEFT, WITHIN = 0.01, 0.25
"""What may be left of a wrong first state, after what part of the longest record."""
_FIRST, _MORE, _ATTEMPTS = 1e-10, 10.0, 16
"""Noise that is supposed of a mode that remembers, re its own size; by how much more at each attempt."""


def slowest(samples: int) -> float:
    """Return how far from zero the poles of a predictor may lie, when the longest record has so many samples."""
    return float(LEFT ** (1 / (WITHIN * samples)))


def forgetting(
    transition: np.ndarray, outlet: np.ndarray, gain: np.ndarray, innovation: np.ndarray, radius: float
) -> np.ndarray:
    """Return a Kalman gain with which the predictor's poles lie within a radius, and as little else as can be changes.

    Oscillations that last as long as the record are predicted best by a gain of hardly anything, from a first state
    that was fitted to all of it: nobody who starts such a predictor has that.  A little noise is supposed to drive
    the modes that remember for too long, as much as makes the best predictor of such a system forget.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A.
    outlet : array, shape (p, n), any unit
        C.
    gain : array, shape (n, p), 1 per the outputs' units
        K, with a stable predictor.
    innovation : array, shape (p, p), products of the outputs' units
    radius : float, 1

    Returns
    -------
    array, shape (n, p), 1 per the outputs' units
        K as it was where nothing does.
    """
    process, extra, found = np.zeros_like(transition), _FIRST, gain
    for _ in range(_ATTEMPTS):
        poles, shapes = np.linalg.eig(transition - found @ outlet)
        slow = np.abs(poles) >= radius
        if not slow.any():
            return found
        modes = shapes[:, slow] / np.maximum(np.linalg.norm(outlet @ shapes[:, slow], axis=0), 1e-300)
        process = process + extra * np.trace(innovation) * (modes @ modes.conj().T).real
        extra *= _MORE
        try:
            predictor = transition - gain @ outlet
            error = filter_covariance(predictor, outlet, process, innovation)
            more = np.linalg.solve(outlet @ error @ outlet.T + innovation, (predictor @ error @ outlet.T).T).T
        except (LinAlgError, ValueError):
            continue
        if is_stable(predictor - more @ outlet):
            found = gain + more
    return gain
