"""The compiled kernel of valve position control: two PI controllers an axis."""

import math

from numba import njit

from rigkit.flush_kernel import flushed

FAST_INTEGRAL, SLOW_INTEGRAL, SLOW_MODEL, FAST, SLOW, BLIND, CELLS = range(7)
"""Of `memory`, a row an axis: m; the last references, m; samples in which an input was no number."""
FAST_GAIN, FAST_RATE, SLOW_GAIN, SLOW_RATE, TRACKING, LIMIT, INNER_GAIN, MIDDLE, FEED, POLE, SETTINGS = range(11)
"""Of `settings`, a row an axis: 1, 1 a sample, 1, 1 a sample, 1 a sample, m/s, 1/s, m, 1, 1."""


@njit(cache=True, nogil=True)
def _step(error, signal, given, state):  # type: ignore[no-untyped-def]
    """Do one sample of one axis; where an input is no number, everything stays as it is."""
    if not math.isfinite(error + signal):
        state[BLIND] += 1.0
        return
    excess = min(max(signal, -given[LIMIT]), given[LIMIT]) - signal
    state[FAST_INTEGRAL] += given[TRACKING] * excess / given[INNER_GAIN]
    fast = given[FAST_GAIN] * error + state[FAST_INTEGRAL] - given[FEED] * state[SLOW_MODEL]
    slow = given[SLOW_GAIN] * fast + state[SLOW_INTEGRAL]
    state[FAST_INTEGRAL] += given[FAST_RATE] * error
    state[SLOW_INTEGRAL] += given[SLOW_RATE] * fast
    state[SLOW_MODEL] = flushed(state[SLOW_MODEL] + (1.0 - given[POLE]) * (slow - state[SLOW_MODEL]))
    state[FAST], state[SLOW] = fast, slow


@njit(cache=True, nogil=True)
def run(reference, relative, control, fast_reference, slow_reference, settings, memory):  # type: ignore[no-untyped-def]
    """Run one frame: signals are shape (frames, axes)."""
    for n in range(len(reference)):
        for axis in range(reference.shape[1]):
            given, state = settings[axis], memory[axis]
            _step(reference[n, axis] - relative[n, axis], control[n, axis], given, state)
            fast_reference[n, axis], slow_reference[n, axis] = state[FAST] + given[MIDDLE], state[SLOW]
