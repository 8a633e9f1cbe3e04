"""What guided motion makes of its references, sample by sample: delay, low-pass, speed limit, and the gears' errors."""

import numpy as np
from numba import njit

from firmware_sim.plants.flush_kernel import flushed


@njit(cache=True, nogil=True)
def guide(
    reference: np.ndarray,
    driven: np.ndarray,
    planned: np.ndarray,
    error: np.ndarray,
    line: np.ndarray,
    at: np.ndarray,
    now: np.ndarray,
    pole: float,
    step: float,
    gears: np.ndarray,
) -> None:
    """Fill `planned` (what is asked of the motors), `driven` (with the gears' errors) and `error`, (frames, 6), rad.

    `line` (delay, 6) holds references on their way, `at[0]` the oldest; `now` (6,) is where guided motion is, and
    `step` (rad) the most it moves in a sample; `gears` (2, 3, 6) is that of `draw_gear_error`.
    """
    for n in range(reference.shape[0]):
        for i in range(6):
            come = line[at[0], i]
            line[at[0], i] = reference[n, i]
            now[i] = flushed(now[i] + min(max((1.0 - pole) * (come - now[i]), -step), step))
            planned[n, i] = now[i]
            error[n, i] = 0.0
            for k in range(2):
                error[n, i] += gears[k, 0, i] * np.sin(gears[k, 1, i] * now[i] + gears[k, 2, i])
            driven[n, i] = now[i] + error[n, i]
        at[0] = (at[0] + 1) % line.shape[0]
