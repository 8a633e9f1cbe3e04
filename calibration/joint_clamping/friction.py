"""Friction of a slow motion to and fro: after a reversal it goes over from one sign to the other within a distance."""

import numpy as np

from rigkit.compiled import njit


def friction_shape(angle: np.ndarray, distance: float) -> np.ndarray:
    """Return friction over its largest value: Dahl's model, driven by the motion.

    dF/dx = (1 - F sign(dx)) / distance; it starts from 0.

    Parameters
    ----------
    angle : array, shape (samples,), any unit
    distance : float, the angle's unit
        > 0.  In which friction comes to within 1/e of its value.

    Returns
    -------
    array, shape (samples,), 1

    Source
    ------
    P. R. Dahl, A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1, 1968, with exponent 1.
    """
    found: np.ndarray = _dahl(angle, distance)
    return found


@njit(cache=True, nogil=True)
def _dahl(angle: np.ndarray, distance: float) -> np.ndarray:
    found = np.empty(len(angle))
    value, before = 0.0, angle[0]
    for n in range(len(angle)):
        step = angle[n] - before
        sign = 1.0 if step > 0 else -1.0
        value = sign + (value - sign) * np.exp(-abs(step) / distance)  # exact for a straight step
        before = angle[n]
        found[n] = value
    return found
