"""About which point of rest the records lie."""

import numpy as np

WITHIN = 1.0
"""How far from the outputs' mean, re their spread, a point of rest is believed where the inputs' mean leads to it."""

_LEAK = 1e-12


def rest_near(
    system: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], level: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the point of rest that is nearest to the means of inputs and outputs, in units of their spread.

    The mean of the inputs holds the outputs of most plants near to their own mean.  What integrates, or nearly, would
    end up anywhere: there other inputs hold the outputs where they were.

    Parameters
    ----------
    system : A, B, C and D, arrays of shapes (n, n), (n, m), (p, n) and (p, m), 1
    level : array, shape (p,), 1
        Where the mean of the inputs holds the outputs, from their mean.

    Returns
    -------
    inputs, outputs : arrays, shapes (m,) and (p,), 1
        From their means: zero and `level` where that lies within the outputs' spread.
    """
    transition, inlet, outlet, direct = system
    still = np.zeros(inlet.shape[1])
    if not np.any(np.abs(level) > WITHIN) or not len(still):
        return still, level
    leaky = (1.0 - _LEAK) * transition  # what integrates has no gain at rest, but a very large one will do
    settled = outlet @ np.linalg.solve(np.eye(len(transition)) - leaky, inlet) + direct
    moved = -np.linalg.solve(settled.T @ settled + np.eye(len(still)), settled.T @ level)
    return moved, level + settled @ moved
