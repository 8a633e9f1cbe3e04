"""The compiled kernel that takes the robot's deflection off a reference as readings of known age come, by sample."""

import math

from numba import njit

from rigkit.flush_kernel import flushed

AT, FADE, STEP = range(3)
"""Of `state`: where the next position goes in `line`, how far it is faded in (0 to 1), by so much a sample."""


@njit(cache=True, nogil=True)
def run(wanted, laser, age, position, reference, line, robot, last_age, state, rate, pole):  # type: ignore[no-untyped-def]
    """Run one frame: shape (frames, axes) each, m and s.

    `line` (samples, axes) holds the last positions, `robot` (2, axes) what was seen of the robot last, and that behind
    the low-pass, `last_age` (axes,) the ages one sample ago.
    """
    length = len(line)
    for n in range(len(wanted)):
        at = int(state[AT])
        state[FADE] = min(max(state[FADE] + state[STEP], 0.0), 1.0)
        weight = 0.5 - 0.5 * math.cos(math.pi * state[FADE])
        for axis in range(wanted.shape[1]):
            line[at, axis] = position[n, axis]
            if not age[n, axis] > last_age[axis] and not math.isnan(laser[n, axis]):
                back = min(int(round(age[n, axis] * rate)), length - 1)
                robot[0, axis] = laser[n, axis] - line[(at - back) % length, axis]
            last_age[axis] = age[n, axis]
            robot[1, axis] = flushed(pole * robot[1, axis] + (1.0 - pole) * robot[0, axis])
            reference[n, axis] = wanted[n, axis] - weight * robot[1, axis] if weight > 0.0 else wanted[n, axis]
        state[AT] = (at + 1) % length
