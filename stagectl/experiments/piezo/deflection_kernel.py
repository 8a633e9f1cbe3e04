"""The compiled kernel that takes the robot's deflection off a reference, a sample at a time."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed


@njit(cache=True, nogil=True)
def run(
    wanted: np.ndarray,
    absolute: np.ndarray,
    position: np.ndarray,
    reference: np.ndarray,
    line: np.ndarray,
    robot: np.ndarray,
    at: np.ndarray,
    pole: float,
) -> None:
    """Run one frame: shape (frames, axes) each, m; `line` holds the last positions, `at[0]` the oldest of them."""
    for n in range(len(wanted)):
        line[at[0]] = position[n]
        at[0] = (at[0] + 1) % len(line)
        for axis in range(wanted.shape[1]):
            seen = absolute[n, axis] - line[at[0], axis]
            robot[axis] = flushed(pole * robot[axis] + (1.0 - pole) * seen)
            reference[n, axis] = wanted[n, axis] - robot[axis]
