"""The laser check's compiled kernel: a reading that cannot be is held off, and if it lasts, or ages, latched."""

import math

from numba import njit

NONE, STALE, STUCK, RANGE, JUMP = range(5)
PERIOD, OLDEST, STUCK_READINGS, SPEED, LARGEST, ORIGIN, TOLERATED = range(7)
"""Of `bounds`: s a sample, s, readings, m/s, m from `ORIGIN`, m, readings in a row."""
GOOD, GOOD_AGE, RAW, RAW_AGE, REPEATS, WRONG, SEEN, LAST = range(8)
"""Of `memory`, by axis: last valid reading and its age, last reading and its age, how often it came, invalid ones,
whether any was valid, and what was wrong with the newest."""
KIND, AXIS, VALUE, AGE, HELD, GREATEST = range(6)
"""Of `latch`: the first fault, its axis, reading and age; readings held off; the greatest age since it was read."""


@njit(cache=True, nogil=True)
def _wrong(value, gap, memory, bounds):  # type: ignore[no-untyped-def]
    """Return what is wrong with a new reading, taken `gap` s after the one before."""
    if not abs(value - bounds[ORIGIN]) <= bounds[LARGEST]:  # NaN as well
        return RANGE
    if memory[SEEN] and not abs(value - memory[GOOD]) <= bounds[SPEED] * gap:
        return JUMP
    return NONE


@njit(cache=True, nogil=True)
def _checked(value, age, memory, bounds, latch):  # type: ignore[no-untyped-def]
    """Take one sample of an axis; return what has to latch."""
    memory[GOOD_AGE] += bounds[PERIOD]
    is_new = not memory[RAW_AGE] < age  # an age that has not grown: a new reading
    gap = memory[RAW_AGE] + bounds[PERIOD] - age
    memory[RAW_AGE] = age
    has_to = NONE
    if is_new:
        kind = _wrong(value, gap, memory, bounds)
        memory[LAST] = kind
        memory[REPEATS] = memory[REPEATS] + 1.0 if value == memory[RAW] else 0.0
        memory[RAW] = value
        if kind == NONE:
            memory[GOOD], memory[GOOD_AGE], memory[WRONG], memory[SEEN] = value, age, 0.0, 1.0
        else:
            memory[WRONG] += 1.0
            latch[HELD] += 1.0
            has_to = kind if memory[WRONG] > bounds[TOLERATED] else NONE
        if memory[REPEATS] >= bounds[STUCK_READINGS]:
            has_to = STUCK
    if has_to == NONE and not memory[GOOD_AGE] <= bounds[OLDEST]:
        has_to = STALE if memory[LAST] == NONE else memory[LAST]
    return has_to


@njit(cache=True, nogil=True)
def run(reading, age, valid, valid_age, fault, bounds, memory, latch):  # type: ignore[no-untyped-def]
    """Check one frame: shape (frames, axes) each, m and s; `fault` is shape (frames, 1), 0 where there is none."""
    for n in range(len(reading)):
        for axis in range(reading.shape[1]):
            own = memory[axis]
            kind = _checked(reading[n, axis], age[n, axis], own, bounds, latch)
            latch[GREATEST] = max(latch[GREATEST], own[GOOD_AGE])
            if kind != NONE and latch[KIND] == NONE:
                latch[KIND], latch[AXIS], latch[VALUE], latch[AGE] = kind, axis, own[RAW], own[GOOD_AGE]
            valid[n, axis] = own[GOOD] if own[SEEN] else math.nan
            valid_age[n, axis] = own[GOOD_AGE]
        fault[n, 0] = latch[KIND]
