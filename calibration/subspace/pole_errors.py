"""How sure natural frequencies and damping ratios are: by leaving out a segment of the records at a time."""

from dataclasses import dataclass

import numpy as np

from calibration.state_space.modes import Modes, frequency_and_damping
from calibration.subspace.estimate import compress
from calibration.subspace.realization import Method, transition
from calibration.subspace.replicates import spread
from calibration.subspace.windows import Windows


@dataclass(frozen=True)
class PoleErrors:
    """Standard errors, mode by mode in the order of the model's `modes`.

    Parameters
    ----------
    frequency : array, shape (modes,), Hz
        Infinite for a pole that is at zero in one of the estimates.
    damping : array, shape (modes,), 1
    """

    frequency: np.ndarray
    damping: np.ndarray


def pole_errors(windows: Windows, method: Method, modes: Modes, order: int, rate: float) -> PoleErrors:
    """Estimate the poles without each segment in turn, and from their spread how uncertain they are.

    Segments are far longer than what noise remembers, so that they are independent; what all of them have in common
    (a horizon that misses a slow mode, a machine that is not linear) does not show.  Of records without noise and of
    a single segment the spread is zero.

    Parameters
    ----------
    windows : Windows
    method : "n4sid" or "moesp"
    modes : Modes
        Of the estimate from all segments.
    order : int
    rate : float, samples/s

    Source
    ------
    Efron 1982, The Jackknife, the Bootstrap and Other Resampling Plans, chapter 3; Kuensch 1989, "The jackknife and the
    bootstrap for general stationary observations", Ann. Stat. 17, 1217-1241.
    """
    from scipy.optimize import linear_sum_assignment  # slow to import

    count = windows.segments
    frequency, damping = np.empty((count, len(modes.pole))), np.empty((count, len(modes.pole)))
    for segment in range(count):
        gamma = compress(windows, method, without=[segment]).projection.observability(order)
        poles = np.linalg.eigvals(transition(gamma, windows.layout.outputs)[0]).astype(complex)
        _, nearest = linear_sum_assignment(np.abs(modes.pole[:, None] - poles))
        frequency[segment], damping[segment] = frequency_and_damping(poles[nearest], rate)
    return PoleErrors(_finite(frequency), _finite(damping))


def _finite(without: np.ndarray) -> np.ndarray:
    """Return the standard error, infinite where one of the estimates is."""
    known = np.isfinite(without).all(axis=0)
    return np.where(known, spread(np.where(known, without, 0.0)), np.inf)
