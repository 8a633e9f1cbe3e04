"""What a system's states keep of what enters them: sums over all time."""

import numpy as np

_DOUBLINGS = 25
"""Of the terms: enough for a time constant of a million samples."""


def summed(transition: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Return the sum over k of A^k P A'^k, shape (n, n), the solution X of X = A X A' + P.

    Each step takes twice as many terms: there is no equation to solve, which a pole near 1 would spoil.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A, stable.
    first : array, shape (n, n), any unit
        P.
    """
    total: np.ndarray = first
    power = transition
    for _ in range(_DOUBLINGS):
        total = total + power @ total @ power.T
        power = power @ power
        if not np.abs(power).max() > np.finfo(float).eps:
            break
    return total
