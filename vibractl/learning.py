"""Frequency-domain iterative learning control: one update, its gains, and its first drive."""

from dataclasses import dataclass

import numpy as np
from numba import njit


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


@dataclass(frozen=True)
class Gains:
    """K(k) in stages: `stages[i]` updates with `gains[i]`, and the last gain ever after.

    Parameters
    ----------
    gains : floats, 1, each 0 to 1
    stages : ints, updates, one fewer than the gains

    Raises
    ------
    ValueError : the numbers do not fit, or a gain is outside 0 to 1.

    Source
    ------
    Sörnmo 2015, eq. (6.11), (6.24), (6.25).

    Examples
    --------
    >>> [Gains((0.3, 0.15), (15,)).at(k) for k in (0, 14, 15)]
    [0.3, 0.3, 0.15]
    """

    gains: tuple[float, ...]
    stages: tuple[int, ...]

    def __post_init__(self) -> None:
        """Check that stages and gains fit."""
        if len(self.gains) != len(self.stages) + 1:
            raise ValueError(
                f"learning.stages has {len(self.stages)} stages for {len(self.gains)} gains, must have one fewer"
            )
        for gain in self.gains:
            if not 0 <= gain <= 1:
                raise ValueError(f"learning.gains has {gain!r}, must be 0 to 1")
        for stage in self.stages:
            if stage < 1:
                raise ValueError(f"learning.stages has {stage!r}, must be >= 1 shots")

    def at(self, shot: int) -> float:
        """Return K for the update after shot `shot`, the first being 0."""
        for gain, stage in zip(self.gains, self.stages, strict=False):
            if shot < stage:
                return gain
            shot -= stage
        return self.gains[-1]


SINE_GAINS = Gains((1.0, 0.25), (12,))
"""Sörnmo 2015, eq. (6.24)."""
CHIRP_GAINS = Gains((0.3, 0.15), (15,))
"""Sörnmo 2015, eq. (6.25)."""
KALMAN_GAINS = Gains((0.8, 0.4), (7,))
"""Where the model follows the plant, and so may be trusted with more."""
