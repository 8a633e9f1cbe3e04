"""The compiled kernel of valve position control: two PI controllers an axis."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record


@njit(cache=True, nogil=True)
def step(axis: Record, error: float, signal: float) -> None:
    """Do one sample of one axis; where an input is no number, everything stays as it is."""
    if not math.isfinite(error + signal):
        axis.blind += 1
        return
    excess = min(max(signal, -axis.limit), axis.limit) - signal
    axis.fast_integral += axis.tracking * excess / axis.inner_gain
    fast = axis.fast_gain * error + axis.fast_integral - axis.feed * axis.slow_model
    slow = axis.slow_gain * fast + axis.slow_integral
    axis.fast_integral += axis.fast_rate * error
    axis.slow_integral += axis.slow_rate * fast
    axis.slow_model = flushed(axis.slow_model + (1.0 - axis.pole) * (slow - axis.slow_model))
    axis.fast, axis.slow = fast, slow


@njit(cache=True, nogil=True)
def run(
    reference: np.ndarray,
    relative: np.ndarray,
    control: np.ndarray,
    fast_reference: np.ndarray,
    slow_reference: np.ndarray,
    axes: np.ndarray,
) -> None:
    """Run one frame: signals are shape (frames, axes), `axes` records of `VALVE`."""
    for n in range(len(reference)):
        for number in range(axes.size):
            axis = axes[number]
            step(axis, reference[n, number] - relative[n, number], control[n, number])
            fast_reference[n, number], slow_reference[n, number] = axis.fast + axis.middle, axis.slow
