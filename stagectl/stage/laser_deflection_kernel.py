"""The compiled kernel that takes the robot's deflection off a reference as readings of known age come, by sample."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed

FADE = np.dtype(
    [
        ("at", "i8"),  # where the next position goes
        ("faded", "f8"),  # how far compensation is faded in, 0 to 1
        ("step", "f8"),  # by so much a sample
        ("rate", "f8"),  # samples/s
        ("pole", "f8"),  # of the low-pass
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def run(
    wanted: np.ndarray,
    seen: tuple[np.ndarray, np.ndarray, np.ndarray],
    reference: np.ndarray,
    line: np.ndarray,
    robot: np.ndarray,
    last_age: np.ndarray,
    states: np.ndarray,
) -> None:
    """Run one frame: shape (frames, axes) each; `seen` are laser (m), its reading's age (s) and position (m).

    `line` (samples, axes) holds the last positions, `robot` (2, axes) what was seen of the robot last, and that behind
    the low-pass, `last_age` (axes,) the ages one sample ago; `states` is of one `FADE`.
    """
    laser, age, position = seen
    state, length = states[0], len(line)
    for n in range(len(wanted)):
        at = state.at
        state.faded = min(max(state.faded + state.step, 0.0), 1.0)
        weight = 0.5 - 0.5 * math.cos(math.pi * state.faded)
        for axis in range(wanted.shape[1]):
            line[at, axis] = position[n, axis]
            if not age[n, axis] > last_age[axis] and not math.isnan(laser[n, axis]):
                back = min(int(round(age[n, axis] * state.rate)), length - 1)
                robot[0, axis] = laser[n, axis] - line[(at - back) % length, axis]
            last_age[axis] = age[n, axis]
            robot[1, axis] = flushed(state.pole * robot[1, axis] + (1.0 - state.pole) * robot[0, axis])
            reference[n, axis] = wanted[n, axis] - weight * robot[1, axis] if weight > 0.0 else wanted[n, axis]
        state.at = (at + 1) % length
