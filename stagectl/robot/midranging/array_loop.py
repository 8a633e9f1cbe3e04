"""Discrete loops given as plain arrays, transfer functions or state spaces: as models with a dead time, or stepped."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from rigkit.discrete_system import arrays_of, is_system
from stagectl.robot.midranging.axis_record import ORDER
from stagectl.robot.midranging.tuning import LoopModel

System = Sequence[Any]
"""(numerator, denominator) in falling powers of z, (A, B, C), (A, B, C, D), or a system of scipy.signal or control."""
NOTHING = 1e-12
"""Share of the largest coefficient that is rounding."""


def coefficients(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Return a discrete loop's transfer function in powers of z^-1.

    Parameters
    ----------
    system : (numerator, denominator) or (A, B, C) or (A, B, C, D), scipy.signal.dlti, or of python-control
        One input, one output, strictly proper: arrays of falling powers of z, or a state space's.

    Returns
    -------
    arrays, shape (n + 1,) each
        b_0 = 0, b_1 ... and 1, -a_1 ...: y_k = sum a_i y_{k-i} + sum b_i w_{k-i}.

    Raises
    ------
    ValueError : another form, a value that is not finite, or a loop whose input is seen in the same sample.

    Examples
    --------
    >>> coefficients(([0.5], [1.0, -0.5, 0.0]))
    (array([0. , 0. , 0.5]), array([ 1. , -0.5,  0. ]))
    """
    if is_system(system):
        system = arrays_of(system)
    if len(system) == 2:
        numerator, denominator = (np.trim_zeros(np.atleast_1d(np.asarray(each, float)), "f") for each in system)
    elif len(system) in (3, 4):
        numerator, denominator = _of_state_space(*(np.atleast_2d(np.asarray(each, float)) for each in system))
    else:
        raise ValueError(f"a loop has {len(system)} arrays, must be (numerator, denominator) or (A, B, C) or with D")
    if not (np.isfinite(numerator).all() and np.isfinite(denominator).all()):
        raise ValueError("a loop has a coefficient that is not finite")
    if not 1 <= len(numerator) < len(denominator):
        raise ValueError(
            f"a loop has {len(numerator)} coefficients over {len(denominator)}, must have fewer above, and one at least"
        )
    b = np.concatenate([np.zeros(len(denominator) - len(numerator)), numerator]) / denominator[0]
    return b, denominator / denominator[0]


def _of_state_space(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return numerator and denominator, falling powers of z, from A (n, n), B (n, 1), C (1, n) and D (1, 1)."""
    order = len(a)
    b = b.reshape(-1, 1)
    if a.shape != (order, order) or len(b) != order or c.shape != (1, order):
        raise ValueError(f"a loop has A {a.shape}, B {b.shape}, C {c.shape}, must be (n, n), (n, 1), (1, n)")
    if d is not None and np.any(d != 0.0):
        raise ValueError(f"a loop has D {d.ravel().tolist()}, must be 0: what it is given is seen a sample later")
    denominator = np.poly(a)
    markov = np.array([(c @ np.linalg.matrix_power(a, power) @ b)[0, 0] for power in range(order)])
    numerator = np.convolve(denominator, markov)[:order]
    numerator[np.abs(numerator) < NOTHING * np.abs(numerator).max()] = 0.0
    return np.trim_zeros(numerator, "f"), denominator


def as_model(system: System) -> tuple[LoopModel, int]:
    """Return a loop as a model of order 1 to 3, and its dead time beyond one sample, in samples.

    Parameters
    ----------
    system : as of `coefficients`

    Raises
    ------
    ValueError : as of `coefficients`; a loop of higher order, an unstable one, or one whose gain at rest is far from 1.
    """
    b, a = coefficients(system)
    delay = int(np.flatnonzero(b)[0]) - 1
    outputs, inputs = np.trim_zeros(-a[1:], "b"), np.trim_zeros(b[1 + delay :], "b")
    order = max(len(outputs), len(inputs))
    if order > ORDER:
        raise ValueError(f"a loop is of order {order} beside its dead time, must be 1 to {ORDER}: reduce it")
    padded = (tuple(np.pad(each, (0, order - len(each))).tolist()) for each in (outputs, inputs))
    return LoopModel(*padded), delay


class Stepped:
    """A rational system, from its input sample by sample, at rest at first.

    Parameters
    ----------
    b, a : array, shape (n,), in powers of z^-1, a_0 not 0
    """

    def __init__(self, b: np.ndarray, a: np.ndarray) -> None:
        length = max(len(b), len(a))
        self._b, self._a = (np.pad(each, (0, length - len(each))) / a[0] for each in (b, a))
        self._state = np.zeros(length)

    @property
    def free(self) -> float:
        """What the output is now without the input of now."""
        return float(self._state[0])

    def step(self, value: float) -> float:
        """Take the input of now; return the output of now."""
        made = float(self._state[0] + self._b[0] * value)
        self._state[:-1] = self._state[1:] + self._b[1:] * value - self._a[1:] * made
        return made
