"""A discrete plant of one input and one output as plain arrays, also one of scipy.signal or python-control."""

from typing import Any

import numpy as np

Arrays = tuple[np.ndarray, ...]
"""(numerator, denominator) in falling powers of z, or (A, B, C) or (A, B, C, D)."""


def is_system(given: Any) -> bool:
    """Say whether this is an object of scipy.signal or python-control: it has a sample period."""
    return hasattr(given, "dt")


def arrays_of(system: Any) -> Arrays:
    """Return the arrays of a discrete system.

    Parameters
    ----------
    system : scipy.signal.dlti, control.TransferFunction or control.StateSpace

    Returns
    -------
    (numerator, denominator) of a transfer function or of zeros and poles, (A, B, C, D) of a state space

    Raises
    ------
    ValueError : continuous, of several inputs or outputs, or of another kind.

    Examples
    --------
    >>> from scipy.signal import dlti
    >>> arrays_of(dlti([0.5], [1.0, -0.5], dt=0.01))
    (array([0.5]), array([ 1. , -0.5]))
    """
    period = system.dt
    if period is None or not period > 0:
        raise ValueError(
            f"the system's sample period is dt = {period}, must be > 0 s: sample it first, as by "
            "scipy.signal.cont2discrete or control.sample_system"
        )
    if all(hasattr(system, name) for name in "ABCD"):
        return tuple(np.atleast_2d(np.asarray(getattr(system, name), float)) for name in "ABCD")
    if not hasattr(system, "num") and hasattr(system, "zeros"):
        system = system.to_tf()
    if not hasattr(system, "num"):
        raise ValueError(f"the system is a {type(system).__name__}, must be a transfer function or a state space")
    return _only(system.num), _only(system.den)


def impulse_response(arrays: Arrays, samples: int) -> np.ndarray:
    """Return what a plant answers to a one at sample 0, shape (samples,), dead time included.

    Parameters
    ----------
    arrays : Arrays
    samples : int

    Raises
    ------
    ValueError : arrays of another form.

    Examples
    --------
    >>> impulse_response(([0.5], [1.0, -0.5, 0.0]), 4)
    array([0.  , 0.  , 0.5 , 0.25])
    """
    if len(arrays) == 2:
        numerator, denominator = (np.atleast_1d(np.asarray(each, float)) for each in arrays)
        return _of_transfer_function(numerator, denominator, samples)
    if len(arrays) not in (3, 4):
        raise ValueError(
            f"the plant has {len(arrays)} arrays, must be (numerator, denominator) or (A, B, C) or (A, B, C, D)"
        )
    a, b, c, *direct = (np.atleast_2d(np.asarray(each, float)) for each in arrays)
    state, order = b.reshape(-1), len(a)
    if a.shape != (order, order) or len(state) != order or c.shape != (1, order):
        raise ValueError(f"the plant has A {a.shape}, B {b.shape}, C {c.shape}, must be (n, n), (n, 1), (1, n)")
    taps = np.zeros(samples)
    taps[:1] = direct[0].item() if direct else 0.0
    for sample in range(1, samples):
        taps[sample] = (c @ state).item()
        state = a @ state
    return taps


def _of_transfer_function(numerator: np.ndarray, denominator: np.ndarray, samples: int) -> np.ndarray:
    denominator = np.trim_zeros(denominator, "f")
    numerator = np.trim_zeros(numerator, "f")
    late = len(denominator) - len(numerator)
    if not len(denominator) or late < 0:
        raise ValueError(
            f"the plant has {len(numerator)} coefficients over {len(denominator)} in falling powers of z, must not "
            "have more above"
        )
    taps = np.pad(numerator / denominator[0], (late, samples))[:samples]
    back = denominator[:0:-1] / denominator[0]
    for sample in range(1, samples):
        known = taps[max(sample - len(back), 0) : sample]
        taps[sample] -= known @ back[len(back) - len(known) :]
    return taps


def _only(nested: Any) -> np.ndarray:
    """Return the coefficients of the only element of lists in lists."""
    while len(nested) == 1 and np.ndim(nested[0]):
        nested = nested[0]
    if np.ndim(nested[0]):
        raise ValueError("the system has several inputs or outputs, must have one of each")
    return np.asarray(nested, float)
