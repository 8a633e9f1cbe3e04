"""The compiled kernel that estimates kappa and beta: two Kalman filters of one state each."""

import math

from numba import njit

KAPPA, KAPPA_VARIANCE, BETA, BETA_VARIANCE, LAST_FORCE, IS_FRESH, STATE = range(7)
"""Of `state`: m/(N s), its square, 1, 1, N, and whether that is of the sample before."""
STIFFNESS, PERIOD, FORCE_NOISE, VELOCITY_NOISE, KAPPA_DRIFT, BETA_DRIFT, GATE, LEAST, MOST, SETTINGS = range(10)
"""Of `settings`: K_f, N/m; s; variances of force and velocity, N^2 and (m/s)^2, and of what kappa and beta change by in
a sample; N; lowest and highest kappa."""


@njit(cache=True, nogil=True)
def _update(state, at, regressor, measured, noise, drift):  # type: ignore[no-untyped-def]
    """Update the number at `at` and its variance behind it from measured = regressor * number + noise."""
    variance = state[at + 1] + drift
    gain = variance * regressor / (regressor * regressor * variance + noise)
    state[at] += gain * (measured - regressor * state[at])
    state[at + 1] = variance * noise / (regressor * regressor * variance + noise)


@njit(cache=True, nogil=True)
def widening(state):  # type: ignore[no-untyped-def]
    """Return sqrt(1 + beta^2)."""
    return math.sqrt(1.0 + state[BETA] * state[BETA])


@njit(cache=True, nogil=True)
def observe(state, settings, velocity, along, across):  # type: ignore[no-untyped-def]
    """Take in a sample: mean velocity since the one before (m/s), force against the feed and across it (N).

    Nothing is learned while the force is within the gate, nor in the first sample after that.
    """
    if not along > settings[GATE]:
        state[IS_FRESH] = 0.0
        return
    noise = settings[FORCE_NOISE] * (1.0 + state[BETA] * state[BETA])
    _update(state, BETA, along, across, noise, settings[BETA_DRIFT])
    force, wide = math.hypot(along, across), widening(state)
    if state[IS_FRESH] > 0.5:
        rise = (force - state[LAST_FORCE]) / (settings[PERIOD] * settings[STIFFNESS])
        noise = 2.0 * settings[FORCE_NOISE] / (settings[PERIOD] * settings[STIFFNESS]) ** 2
        noise += wide * wide * settings[VELOCITY_NOISE]
        mean = 0.5 * (force + state[LAST_FORCE])
        _update(state, KAPPA, mean, wide * velocity - rise, noise, settings[KAPPA_DRIFT])
        state[KAPPA] = min(max(state[KAPPA], settings[LEAST]), settings[MOST])
    state[LAST_FORCE], state[IS_FRESH] = force, 1.0
