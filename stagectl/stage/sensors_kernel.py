"""The sensor check's compiled kernel: what a sensor cannot show is held off, and if it lasts, latched."""

import math

import numpy as np
from numba import njit

NONE, FINITE, RANGE, JUMP, STUCK = range(5)
LOW, HIGH, STEP, STUCK_SAMPLES, TOLERATED = range(5)
"""Columns of `bounds`, a row a sensor."""
GOOD, RAW, REPEATS, WRONG, SEEN = range(5)
"""Of `memory`, by sensor and axis: last right value, last value, how often it came, wrong ones in a row, any right."""
KIND, SENSOR, AXIS, SAMPLE, VALUE, ALLOWED_LOW, ALLOWED_HIGH, COUNT, HELD = range(9)
"""Of `latch`: the first fault, samples since prepare, samples held off."""


@njit(cache=True, nogil=True)
def _wrong(value, memory, bounds):  # type: ignore[no-untyped-def]
    """Return what is wrong with a sample, and what is allowed."""
    if not math.isfinite(value):
        return FINITE, -np.inf, np.inf
    if not bounds[LOW] <= value <= bounds[HIGH]:
        return RANGE, bounds[LOW], bounds[HIGH]
    room = bounds[STEP] * (memory[WRONG] + 1.0)
    if memory[SEEN] and not abs(value - memory[GOOD]) <= room:
        return JUMP, memory[GOOD] - room, memory[GOOD] + room
    return NONE, 0.0, 0.0


@njit(cache=True, nogil=True)
def _checked(value, sensor, axis, memory, bounds, latch):  # type: ignore[no-untyped-def]
    """Return the sample to go on with, and latch what has been wrong for too long."""
    kind, low, high = _wrong(value, memory, bounds)
    memory[REPEATS] = memory[REPEATS] + 1.0 if value == memory[RAW] else 0.0
    memory[RAW] = value
    lasts = memory[WRONG] >= bounds[TOLERATED]
    if kind == NONE:
        memory[WRONG], memory[GOOD], memory[SEEN] = 0.0, value, 1.0
        if memory[REPEATS] >= bounds[STUCK_SAMPLES]:
            kind, low, high, lasts = STUCK, 0.0, bounds[STUCK_SAMPLES], True
    else:
        memory[WRONG] += 1.0
        latch[HELD] += 1.0
    if kind != NONE and lasts and latch[KIND] == NONE:
        latch[KIND], latch[SENSOR], latch[AXIS], latch[SAMPLE] = kind, sensor, axis, latch[COUNT]
        latch[VALUE], latch[ALLOWED_LOW], latch[ALLOWED_HIGH] = value, low, high
    return memory[GOOD]


@njit(cache=True, nogil=True)
def run(position, extension, valid_position, valid_extension, fault, bounds, memory, latch):  # type: ignore[no-untyped-def]
    """Check one frame: shape (frames, axes) each, m; `fault` is shape (frames, 1), 0 where there is none."""
    for n in range(len(position)):
        for axis in range(position.shape[1]):
            valid_position[n, axis] = _checked(position[n, axis], 0, axis, memory[0, axis], bounds[0], latch)
            valid_extension[n, axis] = _checked(extension[n, axis], 1, axis, memory[1, axis], bounds[1], latch)
        fault[n, 0] = latch[KIND]
        latch[COUNT] += 1.0
