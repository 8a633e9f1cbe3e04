"""The compiled kernel of force-controlled feed: observer, estimates, outer and inner loop, and what goes wrong.

Numba's cache looks at the date of this file alone: change it with the kernels that it is made of.
"""

import math

from numba import njit

from stagectl.robot.milling import cutting_estimate_kernel as cutting
from stagectl.robot.milling import force_gain_kernel as outer
from stagectl.robot.milling import velocity_loop_kernel as inner

IDLE, APPROACHING, ESTIMATING, CONTROLLING, RETREATING, RETREATED = range(6)
"""Of `PHASE`."""
FINE, OVERLOAD, SENSOR, LEAVING = range(4)
"""Of `REASON`."""
(PHASE, REASON, WANTED, ASKED, SUM, LAST_VELOCITY, LAST_FORCE, TOUCHED, LOST, STRAINED, BLIND, BACK, STATE) = range(13)
"""Of `state`: m/s twice, m, m/s, N, samples of contact, without contact, of overload, without a sensor; m."""
(FORCE, INITIAL, RISE, ENOUGH, CONTACT, CONTACT_SAMPLES, LOST_SAMPLES, APPROACH, MOST, STEP, OVERLOAD_FORCE,
 OVERLOAD_SAMPLES, BLIND_SAMPLES, RETREAT, DISTANCE, KAPPA_ENOUGH, BETA_ENOUGH, KAPPA_VARIANCE, BETA_VARIANCE,
 IS_ADAPTED, RISEN, SETTINGS) = range(22)  # fmt: skip
"""Of `settings`: f_d, N; v_init, m/s; 1 a sample; N; N; samples; samples; m/s; m/s; m/s a sample; N; samples;
samples; m/s; m; variances of kappa and beta at which control begins, and that estimation begins with; 0 or 1; m/s."""


@njit(cache=True, nogil=True)
def _begin(state, settings, estimate, observed):  # type: ignore[no-untyped-def]
    """Begin a segment at rest: what was learned stays, but is in doubt."""
    for cell in range(STATE):
        state[cell] = 0.0
    state[PHASE] = APPROACHING
    for i in range(len(observed)):
        observed[i] = 0.0
    estimate[cutting.KAPPA_VARIANCE] = settings[KAPPA_VARIANCE]
    estimate[cutting.BETA_VARIANCE] = settings[BETA_VARIANCE]
    estimate[cutting.IS_FRESH] = 0.0


@njit(cache=True, nogil=True)
def retreat(state, reason):  # type: ignore[no-untyped-def]
    """Go back, or, between segments, where that may lead into the wood, stay."""
    state[PHASE] = RETREATING if state[PHASE] != IDLE else RETREATED
    state[REASON], state[BACK] = reason, 0.0


@njit(cache=True, nogil=True)
def _watch(state, settings, force, along, is_seen):  # type: ignore[no-untyped-def]
    """Go over to another phase where contact, force or sensor say so."""
    state[BLIND] = 0.0 if is_seen else state[BLIND] + 1.0
    if state[BLIND] >= settings[BLIND_SAMPLES] and state[PHASE] != IDLE:
        retreat(state, SENSOR)
        return
    if not is_seen:
        return
    state[STRAINED] = state[STRAINED] + 1.0 if abs(force) > settings[OVERLOAD_FORCE] else 0.0
    state[TOUCHED] = state[TOUCHED] + 1.0 if along > settings[CONTACT] else 0.0
    state[LOST] = state[LOST] + 1.0 if along < 0.5 * settings[CONTACT] else 0.0
    if state[STRAINED] >= settings[OVERLOAD_SAMPLES]:
        retreat(state, OVERLOAD)
    elif state[PHASE] == IDLE:
        return
    elif state[PHASE] == APPROACHING and state[TOUCHED] >= settings[CONTACT_SAMPLES]:
        state[PHASE] = ESTIMATING
    elif state[PHASE] != APPROACHING and state[LOST] >= settings[LOST_SAMPLES]:
        state[PHASE] = APPROACHING


@njit(cache=True, nogil=True)
def _is_known(estimate, settings):  # type: ignore[no-untyped-def]
    return (
        estimate[cutting.KAPPA_VARIANCE] < settings[KAPPA_ENOUGH]
        and estimate[cutting.BETA_VARIANCE] < settings[BETA_ENOUGH]
    )


@njit(cache=True, nogil=True)
def _controlled(state, settings, weights, estimate, velocity, force, fixed):  # type: ignore[no-untyped-def]
    """Return the feed that the outer loop wants, m/s; from sample to sample, so that new gains make no step."""
    if settings[IS_ADAPTED] > 0.5:
        kappa, wide = estimate[cutting.KAPPA], cutting.widening(estimate)
    else:
        kappa, wide = fixed[0], fixed[1]
    on_velocity, on_force, on_error = outer.gains(kappa, wide, weights)
    moved, risen = velocity - state[LAST_VELOCITY], force - state[LAST_FORCE]
    error = settings[FORCE] - state[LAST_FORCE]
    return state[WANTED] - on_velocity * moved - on_force * risen + on_error * weights[outer.PERIOD] * error


@njit(cache=True, nogil=True)
def _wanted(state, settings, weights, estimate, velocity, force, fixed):  # type: ignore[no-untyped-def]
    """Return the feed wanted in this phase, m/s."""
    phase = state[PHASE]
    if phase == APPROACHING or phase == ESTIMATING:
        if force >= settings[ENOUGH]:
            return state[WANTED]
        most = settings[INITIAL] if phase == APPROACHING else settings[RISEN]
        return min(most, max(settings[APPROACH], state[WANTED] * settings[RISE]))
    if phase == CONTROLLING:
        return _controlled(state, settings, weights, estimate, velocity, force, fixed)
    if phase == RETREATING:
        return -settings[RETREAT]
    return 0.0


@njit(cache=True, nogil=True)
def _limited(state, settings, wanted):  # type: ignore[no-untyped-def]
    """Return the feed within its limits of speed and acceleration; a retreat has only that of speed."""
    if state[PHASE] >= RETREATING:
        return wanted
    low, high = state[WANTED] - settings[STEP], state[WANTED] + settings[STEP]
    return min(max(wanted, low, 0.0), high, settings[MOST])


@njit(cache=True, nogil=True)
def _step(seen, state, settings, weights, fixed, estimate, learning, observed, work, matrices, loop):  # type: ignore[no-untyped-def]
    """Do a sample; `seen`: velocity (m/s), force along and across (N), whether they are to be had, whether it runs."""
    measured, along, across, is_valid, is_running = seen
    if is_running > 0.5 and state[PHASE] == IDLE:
        _begin(state, settings, estimate, observed)
    elif not is_running > 0.5 and state[PHASE] < RETREATING:
        state[PHASE] = IDLE
    velocity = inner.observe(observed, work, matrices, measured, state[ASKED])
    is_seen = is_valid > 0.5 and math.isfinite(along + across)
    force = math.copysign(math.hypot(along, across), along) if is_seen else state[LAST_FORCE]
    if state[PHASE] <= CONTROLLING:
        if is_seen and math.isfinite(measured) and state[PHASE] != IDLE:
            cutting.observe(estimate, learning, measured, along, across)
        _watch(state, settings, force, along, is_seen)
        if state[PHASE] == ESTIMATING and _is_known(estimate, settings):
            state[PHASE], state[LAST_VELOCITY], state[LAST_FORCE] = CONTROLLING, velocity, force
    wanted = _wanted(state, settings, weights, estimate, velocity, force, fixed)
    state[WANTED] = _limited(state, settings, wanted)
    state[LAST_VELOCITY], state[LAST_FORCE] = velocity, force
    if state[PHASE] == IDLE or state[PHASE] == RETREATED:
        state[WANTED], state[ASKED], state[SUM] = 0.0, 0.0, 0.0
    else:
        state[ASKED], state[SUM] = inner.control(observed, state[SUM], matrices, loop, state[WANTED], velocity)
    if state[PHASE] == RETREATING:
        state[BACK] -= state[ASKED] * loop[inner.PERIOD]
        if state[BACK] >= settings[DISTANCE]:
            state[PHASE] = RETREATED
    return velocity, force


@njit(cache=True, nogil=True)
def run(  # type: ignore[no-untyped-def]
    velocity, force, is_valid, is_running,
    reference, wanted, estimated, resultant, kappa, kappa_deviation, beta, beta_deviation, phase,
    state, settings, weights, fixed, estimate, learning, observed, work, matrices, loop,
):  # fmt: skip
    """Run one frame: signals are shape (frames, 1), `force` (frames, 2)."""
    for n in range(len(velocity)):
        seen = velocity[n, 0], force[n, 0], force[n, 1], is_valid[n, 0], is_running[n, 0]
        estimated[n, 0], resultant[n, 0] = _step(
            seen, state, settings, weights, fixed, estimate, learning, observed, work, matrices, loop
        )
        reference[n, 0], wanted[n, 0], phase[n, 0] = state[ASKED], state[WANTED], state[PHASE]
        kappa[n, 0], beta[n, 0] = estimate[cutting.KAPPA], estimate[cutting.BETA]
        kappa_deviation[n, 0] = math.sqrt(estimate[cutting.KAPPA_VARIANCE])
        beta_deviation[n, 0] = math.sqrt(estimate[cutting.BETA_VARIANCE])
