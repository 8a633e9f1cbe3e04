"""The guard's compiled kernel: limits, ramps to rest and latch, a sample at a time over a whole frame."""

import math

from numba import njit

SHUT, RAMPING, OPEN, FADING, LATCHED = range(5)
PHASE, POSITION, RAMP, COUNT, CAUSE, SAMPLE, AXIS, EASING = range(8)
"""Of `state`, whole numbers; cause 1: the sensor check, 2: a request that is no number, 3: somebody outside."""
SENSOR, REQUEST, OUTSIDE = 1, 2, 3
LOW, HIGH, STEP, REST = range(4)
"""Of `bounds`, V."""
LAST, FROM, LIMITED, APART = range(4)
"""Rows of `memory`, an axis a column: last voltage, voltage where a ramp began, samples in which a limit was met, and
how far the first request was off the voltage at which it was let out gently."""


@njit(cache=True, nogil=True)
def trip(state, memory, cause, axis):  # type: ignore[no-untyped-def]
    """Begin to fade, unless it does or is latched already."""
    if state[PHASE] == FADING or state[PHASE] == LATCHED:
        return
    state[PHASE], state[POSITION], state[CAUSE], state[SAMPLE], state[AXIS] = FADING, 0, cause, state[COUNT], axis
    memory[FROM, :] = memory[LAST, :]


@njit(cache=True, nogil=True)
def _let_out(request, memory, bounds, axis):  # type: ignore[no-untyped-def]
    """Return the request within its limits."""
    low = max(bounds[LOW], memory[LAST, axis] - bounds[STEP])
    high = min(bounds[HIGH], memory[LAST, axis] + bounds[STEP])
    if low <= request <= high:
        return request
    memory[LIMITED, axis] += 1.0
    return min(max(request, low), high)


@njit(cache=True, nogil=True)
def _advance(state):  # type: ignore[no-untyped-def]
    """Move a ramp by a sample, and return how far it is: 0 to 1."""
    state[POSITION] += 1
    if state[POSITION] >= state[RAMP]:
        state[PHASE] = LATCHED if state[PHASE] == FADING else SHUT
        return 1.0
    return 0.5 - 0.5 * math.cos(math.pi * state[POSITION] / state[RAMP])


@njit(cache=True, nogil=True)
def _ease(request, memory, state):  # type: ignore[no-untyped-def]
    """Return how much of what is apart is left, 1 to 0, and find out at first what is."""
    if state[EASING] == 1:
        for axis in range(request.size):
            memory[APART, axis] = memory[LAST, axis] - request[axis]
    state[EASING] += 1
    if state[EASING] > state[RAMP]:
        state[EASING] = 0
        return 0.0
    return 0.5 + 0.5 * math.cos(math.pi * (state[EASING] - 2) / state[RAMP])


@njit(cache=True, nogil=True)
def run(request, fault, voltage, bounds, memory, state):  # type: ignore[no-untyped-def]
    """Run one frame: shape (frames, axes) in and out, V; `fault` is shape (frames, 1)."""
    for n in range(len(request)):
        if not fault[n, 0] < 1.0:  # NaN as well
            trip(state, memory, SENSOR, 0)
        if state[PHASE] == OPEN:
            for axis in range(request.shape[1]):
                if not math.isfinite(request[n, axis]):
                    trip(state, memory, REQUEST, axis)
        apart = _ease(request[n], memory, state) if state[PHASE] == OPEN and state[EASING] != 0 else 0.0
        ramping = state[PHASE] == RAMPING or state[PHASE] == FADING
        share = _advance(state) if ramping else 1.0
        for axis in range(request.shape[1]):
            if ramping:
                value = memory[FROM, axis] + share * (bounds[REST] - memory[FROM, axis])
            elif state[PHASE] == OPEN:
                value = _let_out(request[n, axis] + apart * memory[APART, axis], memory, bounds, axis)
            else:
                value = memory[LAST, axis]
            voltage[n, axis] = memory[LAST, axis] = value
        state[COUNT] += 1
