"""The compiled kernel that makes a relative position of a slow, noisy tracker and a quick, quiet stage."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed

AXIS = np.dtype(
    [
        ("by_laser", "?"),  # whether it has one
        ("pole", "f8"),  # of the low-passes
        # m, means while all stands still
        ("zero", "f8"),  # of what the tracker sees
        ("quick_zero", "f8"),  # of what the quick sensors see
        # m, two low-passes in a row
        ("smooth", "f8"),
        ("smoother", "f8"),
    ],
    align=True,
)
CLOCK = np.dtype([("now", "i8"), ("first", "i8"), ("last", "i8")], align=True)
"""Samples: so far, and between which means are taken."""


@njit(cache=True, nogil=True)
def run(
    seen: tuple[np.ndarray, np.ndarray],
    quick: tuple[np.ndarray, np.ndarray],
    wanted: np.ndarray,
    deviation: np.ndarray,
    line: np.ndarray,
    axes: np.ndarray,
    clocks: np.ndarray,
) -> None:
    """Run one frame: shape (frames, 3) each, m; `line` (samples, 3) holds what the quick sensors last saw.

    `seen` is spindle and workpiece, `quick` position and laser; `clocks` is of one `CLOCK`.
    """
    spindle, workpiece = seen
    position, absolute = quick
    clock = clocks[0]
    first, last = clock.first, clock.last
    for n in range(len(spindle)):
        now = clock.now
        slot = now % len(line)
        for number in range(3):
            axis = axes[number]
            here = absolute[n, number] if axis.by_laser else position[n, number]
            before = line[slot, number] if now >= len(line) else here
            line[slot, number] = here
            away = spindle[n, number] - workpiece[n, number] - wanted[n, number] - before
            deviation[n, number] = 0.0
            if now < last:
                if now >= first:
                    axis.zero += away / (last - first)
                    axis.quick_zero += here / (last - first)
                continue
            axis.smooth = flushed(axis.smooth + (1.0 - axis.pole) * (away - axis.zero - axis.smooth))
            axis.smoother = flushed(axis.smoother + (1.0 - axis.pole) * (axis.smooth - axis.smoother))
            deviation[n, number] = axis.smoother + here - axis.quick_zero
        clock.now = now + 1
