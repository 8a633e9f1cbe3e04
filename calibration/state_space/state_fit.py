"""The state from which a free response fits a record best, by least squares."""

import numpy as np
from scipy.linalg import lstsq, qr

from calibration.state_space import model_kernel

_CHUNK = 4096
"""Samples folded into the triangle at a time: what bounds the memory."""
_DECAYED = 1e-10
"""A free response below this part of its largest value says nothing more of the state."""
_RANK = 1e-9
"""Directions of the state seen more weakly than this part of the best seen one are left at zero."""


def fit_state(transition: np.ndarray, outlet: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Find x minimizing the sum over k of |residual[k] - C A^k x|^2.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A.
    outlet : array, shape (p, n), any unit
        C.
    residual : array, shape (N, p), the outputs' units

    Returns
    -------
    array, shape (n,), 1
        The shortest such state where several fit alike.  Zero if free responses grow beyond what a float holds.
    """
    order = len(transition)
    if not order:
        return np.zeros(0)
    matrix = np.ascontiguousarray(transition, float)
    rows = np.array(outlet, float, order="C")
    triangle = np.zeros((0, order + 1))
    largest = 0.0
    for start in range(0, len(residual), _CHUNK):
        part = residual[start : start + _CHUNK]
        free = np.empty((len(part), *rows.shape))
        model_kernel.transient(matrix, rows, free)
        if not np.isfinite(rows).all():
            return np.zeros(order)
        stacked = np.concatenate([free.reshape(-1, order), part.reshape(-1, 1)], axis=1)
        triangle = qr(np.concatenate([triangle, stacked]), mode="r", overwrite_a=True)[0][: order + 1]
        largest = max(largest, float(np.abs(free).max()))
        if not np.abs(rows).max() > _DECAYED * largest:
            break
    state: np.ndarray = lstsq(triangle[:, :order], triangle[:, order], cond=_RANK)[0]
    return state
