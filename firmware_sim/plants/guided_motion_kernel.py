"""What guided motion makes of its references, sample by sample: delay, low-pass, speed limit, and the gears' errors."""

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit

MOTION = np.dtype(
    [
        ("pole", "f8"),  # of the low-pass
        ("step", "f8"),  # rad, the most it moves in a sample
        ("at", "i8"),  # where the oldest reference on its way is
        ("now", "f8", 6),  # rad, where guided motion is
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def guide(
    reference: np.ndarray,
    driven: np.ndarray,
    planned: np.ndarray,
    error: np.ndarray,
    line: np.ndarray,
    gears: np.ndarray,
    motions: np.ndarray,
) -> None:
    """Fill `planned` (what is asked of the motors), `driven` (with the gears' errors) and `error`, (frames, 6), rad.

    `line` (delay, 6) holds references on their way; `gears` (2, 3, 6) is that of `draw_gear_error`; `motions` is of
    one `MOTION`.
    """
    motion = motions[0]
    now, pole, step = motion.now, motion.pole, motion.step
    for n in range(reference.shape[0]):
        for i in range(6):
            come = line[motion.at, i]
            line[motion.at, i] = reference[n, i]
            now[i] = flushed(now[i] + min(max((1.0 - pole) * (come - now[i]), -step), step))
            planned[n, i] = now[i]
            error[n, i] = 0.0
            for k in range(2):
                error[n, i] += gears[k, 0, i] * np.sin(gears[k, 1, i] * now[i] + gears[k, 2, i])
            driven[n, i] = now[i] + error[n, i]
        motion.at = (motion.at + 1) % line.shape[0]
