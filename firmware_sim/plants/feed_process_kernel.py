"""The compiled kernel of a tool that is fed into a workpiece: velocity dynamics, removal, and the force between."""

import math

from numba import njit

from firmware_sim.plants.flush_kernel import flushed

(CORNER, MODE, DAMPING, STIFFNESS, FORCE_NOISE, POSITION_NOISE, KAPPA, KAPPA_SWING, KAPPA_STEP, KAPPA_AT, BETA,
 BETA_SWING, BETA_STEP, BETA_AT, SWING, PERIOD, STEPS, SETTINGS) = range(18)  # fmt: skip
"""Of `settings`: rad/s, rad/s, 1, N/m, N, m; m/(N s) three times, s; 1 three times, s; rad/s; s; steps a sample."""
FILTERED, SPEED, PULL, PLACE, REMOVED, SEEN, DONE, CELLS = range(8)
"""Of `state`: m/s, m/s, m/s^2, m, m, m, samples."""


@njit(cache=True, nogil=True)
def _move(asked, state, given):  # type: ignore[no-untyped-def]
    """Go on by a step of the velocity's dynamics: a low-pass, then a mode."""
    h, omega = given[PERIOD], given[MODE]
    filtered, speed, pull = state[FILTERED], state[SPEED], state[PULL]
    filtered += -math.expm1(-given[CORNER] * h) * (asked - filtered)
    pull += h * (omega * omega * (filtered - speed) - 2.0 * given[DAMPING] * omega * pull)
    state[FILTERED], state[PULL], state[SPEED] = flushed(filtered), flushed(pull), flushed(speed + h * pull)
    state[PLACE] += h * state[SPEED]


@njit(cache=True, nogil=True)
def _cut(kappa, state, given):  # type: ignore[no-untyped-def]
    """Return the force against the feed, N, after a step at constant speed; the workpiece does not pull."""
    moved = given[PERIOD] * state[SPEED]
    before = state[PLACE] - moved - state[REMOVED]
    if before <= 0.0 or state[PLACE] <= state[REMOVED]:
        return given[STIFFNESS] * max(state[PLACE] - state[REMOVED], 0.0)
    decay = kappa * given[STIFFNESS] * given[PERIOD]
    depth = before + -math.expm1(-decay) * (moved / decay - before)
    if depth > 0.0:
        state[REMOVED] = state[PLACE] - depth
    return given[STIFFNESS] * max(depth, 0.0)


@njit(cache=True, nogil=True)
def _varied(time, given, first):  # type: ignore[no-untyped-def]
    """Return kappa or beta as it is at a time, s."""
    value = given[first] + given[first + 1] * math.sin(given[SWING] * time)
    return value + given[first + 2] if time >= given[first + 3] else value


@njit(cache=True, nogil=True)
def run(asked, velocity, force, true_force, kappa, beta, noise, state, given):  # type: ignore[no-untyped-def]
    """Run one frame; signals are shape (frames, 1), forces (frames, 2), `noise` (samples, 3) of unit variance."""
    steps = int(given[STEPS])
    for n in range(len(asked)):
        done = int(state[DONE])
        time = done * given[PERIOD] * steps
        kappa[n, 0], beta[n, 0] = _varied(time, given, KAPPA), _varied(time, given, BETA)
        along = 0.0
        for _ in range(steps):
            _move(asked[n, 0], state, given)
            along = _cut(kappa[n, 0], state, given)
        drawn = noise[done % len(noise)]
        seen = state[PLACE] + given[POSITION_NOISE] * drawn[0]
        velocity[n, 0] = (seen - state[SEEN]) / (given[PERIOD] * steps)
        true_force[n, 0], true_force[n, 1] = along, beta[n, 0] * along
        for part in range(2):
            force[n, part] = true_force[n, part] + given[FORCE_NOISE] * drawn[1 + part]
        state[SEEN], state[DONE] = seen, done + 1.0
