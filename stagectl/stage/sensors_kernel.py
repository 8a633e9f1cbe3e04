"""The sensor check's compiled kernel: what a sensor cannot show is held off, and if it lasts, latched."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.record import Record

NONE, FINITE, RANGE, JUMP, STUCK = range(5)
"""What is wrong with a sample."""

BOUNDS = np.dtype([("low", "f8"), ("high", "f8"), ("step", "f8"), ("stuck", "f8"), ("tolerated", "f8")], align=True)
"""Of one sensor: m, m a sample, and samples."""
MEMORY = np.dtype(
    [
        ("good", "f8"),  # m, the last right value
        ("raw", "f8"),  # m, the last value
        ("repeats", "f8"),  # how often that came
        ("wrong", "f8"),  # samples in a row
        ("seen", "?"),  # whether any was right
    ],
    align=True,
)
"""Of one sensor and axis."""
LATCH = np.dtype(
    [
        # the first fault
        ("kind", "i8"),
        ("sensor", "i8"),
        ("axis", "i8"),
        ("sample", "i8"),
        ("value", "f8"),
        ("low", "f8"),
        ("high", "f8"),
        # samples
        ("count", "i8"),  # since prepare
        ("held", "i8"),  # held off
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def _wrong(value: float, memory: Record, bounds: Record) -> tuple[int, float, float]:
    """Return what is wrong with a sample, and what is allowed."""
    if not math.isfinite(value):
        return FINITE, -np.inf, np.inf
    if not bounds.low <= value <= bounds.high:
        return RANGE, bounds.low, bounds.high
    room = bounds.step * (memory.wrong + 1.0)
    if memory.seen and not abs(value - memory.good) <= room:
        return JUMP, memory.good - room, memory.good + room
    return NONE, 0.0, 0.0


@njit(cache=True, nogil=True)
def _checked(value: float, memory: Record, bounds: Record, latch: Record, place: tuple[int, int]) -> float:
    """Return the sample to go on with, and latch what has been wrong for too long; `place`: sensor and axis."""
    kind, low, high = _wrong(value, memory, bounds)
    memory.repeats = memory.repeats + 1.0 if value == memory.raw else 0.0
    memory.raw = value
    lasts = memory.wrong >= bounds.tolerated
    if kind == NONE:
        memory.wrong, memory.good, memory.seen = 0.0, value, True
        if memory.repeats >= bounds.stuck:
            kind, low, high, lasts = STUCK, 0.0, bounds.stuck, True
    else:
        memory.wrong += 1.0
        latch.held += 1
    if kind != NONE and lasts and latch.kind == NONE:
        latch.kind, latch.sensor, latch.axis, latch.sample = kind, place[0], place[1], latch.count
        latch.value, latch.low, latch.high = value, low, high
    return float(memory.good)


@njit(cache=True, nogil=True)
def run(
    position: np.ndarray,
    extension: np.ndarray,
    valid_position: np.ndarray,
    valid_extension: np.ndarray,
    fault: np.ndarray,
    bounds: np.ndarray,
    memory: np.ndarray,
    latches: np.ndarray,
) -> None:
    """Check one frame: shape (frames, axes) each, m; `fault` is shape (frames, 1), 0 where there is none.

    `bounds` is shape (2,), `memory` (2, axes): position, extension; `latches` is of one `LATCH`.
    """
    latch = latches[0]
    for n in range(len(position)):
        for axis in range(position.shape[1]):
            valid_position[n, axis] = _checked(position[n, axis], memory[0, axis], bounds[0], latch, (0, axis))
            valid_extension[n, axis] = _checked(extension[n, axis], memory[1, axis], bounds[1], latch, (1, axis))
        fault[n, 0] = latch.kind
        latch.count += 1
