"""The laser check's compiled kernel: a reading that cannot be is held off, and if it lasts, or ages, latched."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.record import Record

NONE, STALE, STUCK, RANGE, JUMP = range(5)
"""What is wrong with a laser."""

BOUNDS = np.dtype(
    [
        ("period", "f8"),  # s a sample
        ("oldest", "f8"),  # s
        ("stuck", "f8"),  # readings
        ("speed", "f8"),  # m/s
        ("largest", "f8"),  # m from `origin`
        ("origin", "f8"),  # m
        ("tolerated", "f8"),  # readings in a row
    ],
    align=True,
)
MEMORY = np.dtype(
    [
        ("good", "f8"),  # m, the last valid reading
        ("good_age", "f8"),  # s
        ("raw", "f8"),  # m, the last reading
        ("raw_age", "f8"),  # s
        ("repeats", "f8"),  # how often that came
        ("wrong", "f8"),  # readings in a row
        ("last", "i8"),  # what was wrong with the last one
        ("seen", "?"),  # whether any was valid
    ],
    align=True,
)
"""Of one axis."""
LATCH = np.dtype(
    [
        # the first fault
        ("kind", "i8"),
        ("axis", "i8"),
        ("value", "f8"),  # m, the newest reading
        ("age", "f8"),  # s, of the newest valid one
        # since `prepare` or `clear`
        ("held", "i8"),  # invalid readings
        # since it was asked for
        ("greatest", "f8"),  # s, the greatest age
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def _wrong(value: float, gap: float, memory: Record, bounds: Record) -> int:
    """Return what is wrong with a new reading, taken `gap` s after the one before."""
    if not abs(value - bounds.origin) <= bounds.largest:  # NaN as well
        return RANGE
    if memory.seen and not abs(value - memory.good) <= bounds.speed * gap:
        return JUMP
    return NONE


@njit(cache=True, nogil=True)
def _checked(value: float, age: float, memory: Record, bounds: Record, latch: Record) -> int:
    """Take one sample of an axis; return what has to latch."""
    memory.good_age += bounds.period
    is_new = not memory.raw_age < age  # an age that has not grown: a new reading
    gap = memory.raw_age + bounds.period - age
    memory.raw_age = age
    has_to = NONE
    if is_new:
        kind = _wrong(value, gap, memory, bounds)
        memory.last = kind
        memory.repeats = memory.repeats + 1.0 if value == memory.raw else 0.0
        memory.raw = value
        if kind == NONE:
            memory.good, memory.good_age, memory.wrong, memory.seen = value, age, 0.0, True
        else:
            memory.wrong += 1.0
            latch.held += 1
            has_to = kind if memory.wrong > bounds.tolerated else NONE
        if memory.repeats >= bounds.stuck:
            has_to = STUCK
    if has_to == NONE and not memory.good_age <= bounds.oldest:
        has_to = STALE if memory.last == NONE else memory.last
    return has_to


@njit(cache=True, nogil=True)
def run(
    reading: np.ndarray,
    age: np.ndarray,
    valid: np.ndarray,
    valid_age: np.ndarray,
    fault: np.ndarray,
    limits: np.ndarray,
    memory: np.ndarray,
    latches: np.ndarray,
) -> None:
    """Check one frame: shape (frames, axes) each, m and s; `fault` is shape (frames, 1), 0 where there is none.

    `limits` is of one `BOUNDS`, `memory` is shape (axes,), `latches` of one `LATCH`.
    """
    bounds, latch = limits[0], latches[0]
    for n in range(len(reading)):
        for axis in range(reading.shape[1]):
            own = memory[axis]
            kind = _checked(reading[n, axis], age[n, axis], own, bounds, latch)
            latch.greatest = max(latch.greatest, own.good_age)
            if kind != NONE and latch.kind == NONE:
                latch.kind, latch.axis, latch.value, latch.age = kind, axis, own.raw, own.good_age
            valid[n, axis] = own.good if own.seen else math.nan
            valid_age[n, axis] = own.good_age
        fault[n, 0] = latch.kind
