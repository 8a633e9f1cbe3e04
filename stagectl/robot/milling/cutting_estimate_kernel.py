"""The compiled kernel that estimates kappa and beta: two Kalman filters of one state each."""

import math

from rigkit.compiled import njit
from rigkit.record import Record

SCATTER = 0.04
"""Of the residuals' mean, and of their mean square about it, in a sample: 0.1 s at 250 samples/s."""
MOST_BETA = 5.0
"""Size of beta, beyond which no estimate goes: the force is almost across then, and the feed's part of it is noise."""


@njit(cache=True, nogil=True)
def _updated(
    value: float, variance: float, regressor: float, measured: float, noise: float
) -> tuple[float, float, float]:
    """Return a number and its variance by measured = regressor * number + noise, and the residual."""
    foreseen = regressor * regressor * variance
    residual = measured - regressor * value
    gain = variance * regressor / (foreseen + noise)
    return value + gain * residual, variance * noise / (foreseen + noise), residual


@njit(cache=True, nogil=True)
def widening(cutting: Record) -> float:
    """Return sqrt(1 + beta^2)."""
    return math.sqrt(1.0 + cutting.beta * cutting.beta)


@njit(cache=True, nogil=True)
def beta_noise(cutting: Record) -> float:
    """Return the variance of beta's equation, N^2: that of the sensor, or of what is really left over."""
    noise: float = max(cutting.force_noise * (1.0 + cutting.beta * cutting.beta), cutting.beta_scatter)
    return float(noise)


@njit(cache=True, nogil=True)
def kappa_noise(cutting: Record) -> float:
    """Return the variance of kappa's equation, (m/s)^2: that of the sensors, or of what is really left over.

    A ripple of the teeth, or an arm that rings, is no noise of a sensor; without this it would go into kappa.
    """
    wide = widening(cutting)
    noise = 2.0 * cutting.force_noise / (cutting.period * cutting.stiffness) ** 2
    noise = max(noise + wide * wide * cutting.velocity_noise, cutting.kappa_scatter)
    return float(noise)


@njit(cache=True, nogil=True)
def kappa_drift(cutting: Record) -> float:
    """Return the variance of what kappa changes by in a sample: of soft material in proportion to kappa."""
    drift: float = cutting.kappa_drift * max(1.0, cutting.kappa / cutting.guess) ** 2
    return drift


@njit(cache=True, nogil=True)
def _learn_beta(cutting: Record, along: float, across: float) -> None:
    variance = cutting.beta_variance + cutting.beta_drift
    beta, cutting.beta_variance, residual = _updated(cutting.beta, variance, along, across, beta_noise(cutting))
    cutting.beta = min(max(beta, -MOST_BETA), MOST_BETA)
    left = cutting.beta_left + SCATTER * (residual - cutting.beta_left)
    cutting.beta_scatter += SCATTER * ((residual - left) ** 2 - cutting.beta_scatter)
    cutting.beta_left = left


@njit(cache=True, nogil=True)
def _learn_kappa(cutting: Record, velocity: float, force: float) -> None:
    rise = (force - cutting.last_force) / (cutting.period * cutting.stiffness)
    mean, variance = 0.5 * (force + cutting.last_force), cutting.kappa_variance + kappa_drift(cutting)
    measured = widening(cutting) * velocity - rise
    kappa, cutting.kappa_variance, residual = _updated(cutting.kappa, variance, mean, measured, kappa_noise(cutting))
    cutting.kappa = min(max(kappa, cutting.least), cutting.most)
    left = cutting.kappa_left + SCATTER * (residual - cutting.kappa_left)
    cutting.kappa_scatter += SCATTER * ((residual - left) ** 2 - cutting.kappa_scatter)
    cutting.kappa_left = left


@njit(cache=True, nogil=True)
def observe(cutting: Record, velocity: float, along: float, across: float) -> None:
    """Take in a sample: mean velocity since the one before (m/s), force against the feed and across it (N).

    Nothing is learned while the force is within the gate, nor of kappa in the first sample after that.
    """
    force = math.hypot(along, across)
    if not force > cutting.gate:
        cutting.is_fresh = 0
        return
    _learn_beta(cutting, along, across)
    if cutting.is_fresh:
        _learn_kappa(cutting, velocity, force)
    cutting.last_force, cutting.is_fresh = force, 1
