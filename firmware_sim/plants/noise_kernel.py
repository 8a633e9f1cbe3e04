"""Nearly normal noise from inside a compiled plant."""

import numpy as np

from rigkit.compiled import njit

NOISE_SCALE = np.sqrt(12.0 / 4) / 65_536
"""Times `four_uniforms`: of unit variance."""
_MEAN = 2.0 * 65_535


@njit(cache=True, nogil=True)
def four_uniforms(random: np.ndarray) -> float:
    """Return the next sum of four uniform 16-bit numbers, less its mean; `random` (1,) is their state.

    Nearly normal, never beyond 3.5 deviations.
    """
    word = random[0]
    word ^= word >> np.uint64(12)
    word ^= word << np.uint64(25)
    word ^= word >> np.uint64(27)
    random[0] = word
    word *= np.uint64(0x2545F4914F6CDD1D)  # xorshift64* [Vigna, ACM Trans. Math. Softw. 42 (2016) 30]
    low = np.uint64(0xFFFF)
    total = (word & low) + (word >> np.uint64(16) & low) + (word >> np.uint64(32) & low) + (word >> np.uint64(48))
    return float(np.float64(total) - _MEAN)
