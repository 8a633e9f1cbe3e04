"""The compiled kernel that keeps the stage's reference within its travel, and counts how long it could not."""

import numpy as np

from rigkit.compiled import njit


@njit(cache=True, nogil=True)
def run(
    fast_reference: np.ndarray,
    reference: np.ndarray,
    limited: np.ndarray,
    middle: float,
    reach: float,
    count: np.ndarray,
    patience: float,
) -> int:
    """Run one frame, shape (frames, 3), m; return the axis that was at an end for more than `patience` samples, or -1.

    `count` (4,): samples at an end in a row, an axis each, and all of them together; `limited` gets the longest.
    """
    found = -1
    for n in range(len(reference)):
        limited[n, 0] = 0.0
        for axis in range(3):
            wished = fast_reference[n, axis]
            reference[n, axis] = middle + min(max(wished, -reach), reach)
            if abs(wished) <= reach:
                count[axis] = 0
            else:
                count[axis] += 1
                count[3] += 1
            if count[axis] > patience:
                found = axis
            limited[n, 0] = max(limited[n, 0], count[axis])
    return found
