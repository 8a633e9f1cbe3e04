"""The compiled recursions of a state-space model: free run, one step ahead, and the transient of a state.

Matrices come transposed and contiguous (`A.T.copy()`), so that each step adds columns, which the compiler turns into
vector instructions.
"""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed


@njit(cache=True, nogil=True)
def _add_product(result: np.ndarray, matrix: np.ndarray, vector: np.ndarray) -> None:
    """Add vector @ matrix to result."""
    for row in range(matrix.shape[0]):
        factor = vector[row]
        for column in range(matrix.shape[1]):
            result[column] += factor * matrix[row, column]


@njit(cache=True, nogil=True)
def free_run(
    transition: np.ndarray,
    inlet: np.ndarray,
    outlet: np.ndarray,
    direct: np.ndarray,
    drive: np.ndarray,
    state: np.ndarray,
    response: np.ndarray,
) -> None:
    """Write the response, shape (N, p), to a drive, shape (N, m); `state` is left as it is after the last sample."""
    following = np.empty_like(state)
    for n in range(drive.shape[0]):
        response[n] = 0.0
        _add_product(response[n], outlet, state)
        _add_product(response[n], direct, drive[n])
        following[:] = 0.0
        _add_product(following, transition, state)
        _add_product(following, inlet, drive[n])
        for i in range(len(state)):
            state[i] = flushed(following[i])


@njit(cache=True, nogil=True)
def one_step_ahead(
    model: tuple[np.ndarray, ...], drive: np.ndarray, measured: np.ndarray, state: np.ndarray, predicted: np.ndarray
) -> None:
    """Write what is predicted of each sample, shape (N, p), from those before it; `state` is left after the last.

    `model` is transition, inlet, outlet, direct and gain.
    """
    transition, inlet, outlet, direct, gain = model
    following = np.empty_like(state)
    innovation = np.empty(measured.shape[1])
    for n in range(drive.shape[0]):
        predicted[n] = 0.0
        _add_product(predicted[n], outlet, state)
        _add_product(predicted[n], direct, drive[n])
        innovation[:] = measured[n] - predicted[n]
        following[:] = 0.0
        _add_product(following, transition, state)
        _add_product(following, inlet, drive[n])
        _add_product(following, gain, innovation)
        for i in range(len(state)):
            state[i] = flushed(following[i])


@njit(cache=True, nogil=True)
def transient(transition: np.ndarray, rows: np.ndarray, result: np.ndarray) -> None:
    """Write C, C A, C A^2 ... into result, shape (steps, p, n), and leave the next in `rows`, shape (p, n)."""
    following = np.empty_like(rows)
    for step in range(result.shape[0]):
        result[step] = rows
        following[:] = 0.0
        for output in range(rows.shape[0]):
            _add_product(following[output], transition, rows[output])
            for i in range(rows.shape[1]):
                rows[output, i] = flushed(following[output, i])
