"""The Riccati equation of a filter whose predictor is stable already, by doubling."""

import numpy as np
from scipy.linalg import LinAlgError

_DOUBLINGS, _SETTLED = 60, 1e-14


def filter_covariance(transition: np.ndarray, outlet: np.ndarray, process: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Return P = A P A' - A P C' (C P C' + R)^-1 C P A' + Q, several times faster than by the pencil's eigenvalues.

    Each step doubles the samples that the filter has seen.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A, stable.
    outlet : array, shape (p, n), any unit
        C.
    process : array, shape (n, n), 1
        Q.
    noise : array, shape (p, p), products of the outputs' units
        R, positive definite.

    Raises
    ------
    LinAlgError : nothing finite is arrived at.

    Source
    ------
    Chu, Fan, Lin, Wang 2004, Structure-preserving algorithms for periodic discrete-time algebraic Riccati equations,
    Int. J. Control 77(8), the structured doubling algorithm.
    """
    step, known = transition.T, outlet.T @ np.linalg.solve(noise, outlet)
    spread: np.ndarray = process
    for _ in range(_DOUBLINGS):
        mixed = np.linalg.solve(np.eye(len(step)) + known @ spread, np.concatenate([step, known], axis=1))
        ahead, told = mixed[:, : len(step)], mixed[:, len(step) :]
        more = step.T @ spread @ ahead
        spread = spread + (more + more.T) / 2
        known = known + step @ told @ step.T
        step = step @ ahead
        if not np.isfinite(spread).all():
            break
        if np.abs(more).max(initial=0.0) <= _SETTLED * np.abs(spread).max(initial=0.0):
            return spread
    raise LinAlgError("the filter's covariance does not settle")
