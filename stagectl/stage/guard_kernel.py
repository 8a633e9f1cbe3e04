"""The guard's compiled kernel: limits, ramps to rest and latch, a sample at a time over a whole frame."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.record import Record

SHUT, RAMPING, OPEN, FADING, LATCHED = range(5)
"""Of `phase`."""
SENSOR, REQUEST, OUTSIDE = 1, 2, 3
"""Of `cause`: the sensor check, a request that is no number, somebody outside."""

GUARD = np.dtype(
    [
        ("phase", "i8"),
        ("position", "i8"),  # samples into a ramp
        ("ramp", "i8"),  # samples
        ("count", "i8"),  # samples since prepare
        ("cause", "i8"),
        ("sample", "i8"),  # when it tripped
        ("axis", "i8"),  # at which it tripped
        ("easing", "i8"),  # samples into letting out gently, from 1; 0: no more
        # V; the step is per sample
        ("low", "f8"),
        ("high", "f8"),
        ("step", "f8"),
        ("rest", "f8"),
    ],
    align=True,
)
AXIS = np.dtype(
    [
        ("last", "f8"),  # V
        ("begin", "f8"),  # V, where a ramp began
        ("apart", "f8"),  # V, how far the first request was off the voltage at which it was let out gently
        ("limited", "i8"),  # samples in which a limit was met
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def trip(guard: Record, axes: np.ndarray, cause: int, axis: int) -> None:
    """Begin to fade, unless it does or is latched already."""
    if guard.phase == FADING or guard.phase == LATCHED:
        return
    guard.phase, guard.position, guard.cause, guard.sample, guard.axis = FADING, 0, cause, guard.count, axis
    for number in range(axes.size):
        axes[number].begin = axes[number].last


@njit(cache=True, nogil=True)
def _let_out(request: float, guard: Record, axis: Record) -> float:
    """Return the request within its limits."""
    low: float = max(guard.low, axis.last - guard.step)
    high: float = min(guard.high, axis.last + guard.step)
    if low <= request <= high:
        return request
    axis.limited += 1
    return min(max(request, low), high)


@njit(cache=True, nogil=True)
def _advance(guard: Record) -> float:
    """Move a ramp by a sample, and return how far it is: 0 to 1."""
    position = guard.position + 1
    guard.position = position
    if position >= guard.ramp:
        guard.phase = LATCHED if guard.phase == FADING else SHUT
        return 1.0
    return 0.5 - 0.5 * math.cos(math.pi * position / guard.ramp)


@njit(cache=True, nogil=True)
def _ease(request: np.ndarray, guard: Record, axes: np.ndarray) -> float:
    """Return how much of what is apart is left, 1 to 0, and find out at first what is."""
    easing = guard.easing
    if easing == 1:
        for number in range(axes.size):
            axes[number].apart = axes[number].last - request[number]
    guard.easing = easing + 1 if easing < guard.ramp else 0
    if easing >= guard.ramp:
        return 0.0
    return 0.5 + 0.5 * math.cos(math.pi * (easing - 1) / guard.ramp)


@njit(cache=True, nogil=True)
def run(request: np.ndarray, fault: np.ndarray, voltage: np.ndarray, guards: np.ndarray, axes: np.ndarray) -> None:
    """Run one frame: shape (frames, axes) in and out, V; `fault` is shape (frames, 1), `guards` of one `GUARD`."""
    guard = guards[0]
    for n in range(len(request)):
        if not fault[n, 0] < 1.0:  # NaN as well
            trip(guard, axes, SENSOR, 0)
        if guard.phase == OPEN:
            for number in range(axes.size):
                if not math.isfinite(request[n, number]):
                    trip(guard, axes, REQUEST, number)
        apart = _ease(request[n], guard, axes) if guard.phase == OPEN and guard.easing != 0 else 0.0
        ramping = guard.phase == RAMPING or guard.phase == FADING
        share = _advance(guard) if ramping else 1.0
        for number in range(axes.size):
            axis = axes[number]
            if ramping:
                axis.last = axis.begin + share * (guard.rest - axis.begin)
            elif guard.phase == OPEN:
                axis.last = _let_out(request[n, number] + apart * axis.apart, guard, axis)
            voltage[n, number] = axis.last
        guard.count += 1
