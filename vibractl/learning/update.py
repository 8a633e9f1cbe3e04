"""Frequency-domain iterative learning control: one update."""

import numpy as np

from rigkit.compiled import njit


def update(
    drive: np.ndarray, inverse: np.ndarray, error: np.ndarray, gain: float | np.ndarray, keep: float = 1.0
) -> np.ndarray:
    """Learn the next drive from the error that the last one left: U <- Q1 U + Q2 G^+ E, line by line.

    Parameters
    ----------
    drive : complex array, shape (lines, inputs), V s
    inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
        G^+, see `transfer_matrix.regularized_inverse`.
    error : complex array, shape (lines, outputs), m/s^2 s
        Reference minus response.
    gain : float, or array of shape (lines,), 1
        Q2: 0 on a line freezes it.
    keep : float, 1
        Q1.

    Returns
    -------
    complex array, shape (lines, inputs), V s

    Raises
    ------
    ValueError : shapes disagree.

    Source
    ------
    Sörnmo 2015, eq. (6.9), (6.16).

    Examples
    --------
    >>> update(np.array([[1 + 0j]]), np.array([[[0.5 + 0j]]]), np.array([[2 + 0j]]), 0.3)
    array([[1.3+0.j]])
    """
    lines, inputs, outputs = inverse.shape
    if drive.shape != (lines, inputs) or error.shape != (lines, outputs):
        raise ValueError(f"drive is {drive.shape}, error is {error.shape}, the inverse is {inverse.shape}")
    following = np.empty((lines, inputs), complex)
    gains = _one_kind(np.broadcast_to(np.asarray(gain, dtype=float), (lines,)))
    _update(_one_kind(drive), _one_kind(inverse), _one_kind(error), gains, float(keep), following)
    return following


def _one_kind(array: np.ndarray) -> np.ndarray:
    """Return an array of one kind of memory: the kernel is compiled once, and never while a stream is open."""
    return np.require(array, requirements=["C", "W"])


@njit(cache=True, nogil=True)
def _update(
    drive: np.ndarray,
    inverse: np.ndarray,
    error: np.ndarray,
    gain: np.ndarray,
    keep: float,
    following: np.ndarray,
) -> None:
    for line in range(inverse.shape[0]):
        for i in range(inverse.shape[1]):
            step = 0j
            for o in range(inverse.shape[2]):
                step += inverse[line, i, o] * error[line, o]
            following[line, i] = keep * drive[line, i] + gain[line] * step
