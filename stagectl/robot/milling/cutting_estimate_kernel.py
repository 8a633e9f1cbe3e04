"""The compiled kernel that estimates kappa and beta: two Kalman filters of one state each."""

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def _updated(value: float, variance: float, regressor: float, measured: float, noise: float) -> tuple[float, float]:
    """Return a number and its variance by measured = regressor * number + noise."""
    gain = variance * regressor / (regressor * regressor * variance + noise)
    return value + gain * (measured - regressor * value), variance * noise / (regressor * regressor * variance + noise)


@njit(cache=True, nogil=True)
def widening(cutting: np.record) -> float:
    """Return sqrt(1 + beta^2)."""
    return math.sqrt(1.0 + cutting.beta * cutting.beta)


@njit(cache=True, nogil=True)
def observe(cutting: np.record, velocity: float, along: float, across: float) -> None:
    """Take in a sample: mean velocity since the one before (m/s), force against the feed and across it (N).

    Nothing is learned while the force is within the gate, nor in the first sample after that.
    """
    if not along > cutting.gate:
        cutting.is_fresh = 0
        return
    noise = cutting.force_noise * (1.0 + cutting.beta * cutting.beta)
    cutting.beta, cutting.beta_variance = _updated(
        cutting.beta, cutting.beta_variance + cutting.beta_drift, along, across, noise
    )
    force, wide = math.hypot(along, across), widening(cutting)
    if cutting.is_fresh:
        rise = (force - cutting.last_force) / (cutting.period * cutting.stiffness)
        noise = 2.0 * cutting.force_noise / (cutting.period * cutting.stiffness) ** 2
        noise += wide * wide * cutting.velocity_noise
        mean, variance = 0.5 * (force + cutting.last_force), cutting.kappa_variance + cutting.kappa_drift
        kappa, cutting.kappa_variance = _updated(cutting.kappa, variance, mean, wide * velocity - rise, noise)
        cutting.kappa = min(max(kappa, cutting.least), cutting.most)
    cutting.last_force, cutting.is_fresh = force, 1
