"""The compiled bank of first-order complex filters that a system's modes are."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed


@njit(cache=True, nogil=True)
def modal_responses(
    real: np.ndarray, imaginary: np.ndarray, drive: np.ndarray, state: np.ndarray, result: np.ndarray
) -> None:
    """Write the response of every mode to every drive, before each sample is taken in, and advance `state`.

    f[t + 1] = (real + j imaginary) f[t] + drive[t].  `drive` has shape (N, drives), `state` (2, drives modes) and
    `result` (N, >= 2 drives modes): the real parts, drive by drive, then the imaginary ones.
    """
    modes, half = real.size, state.shape[1]
    for t in range(drive.shape[0]):
        for start in range(0, half, modes):
            push = drive[t, start // modes]
            for mode in range(modes):
                above, below = state[0, start + mode], state[1, start + mode]
                result[t, start + mode] = above
                result[t, half + start + mode] = below
                state[0, start + mode] = flushed(real[mode] * above - imaginary[mode] * below + push)
                state[1, start + mode] = flushed(real[mode] * below + imaginary[mode] * above)
