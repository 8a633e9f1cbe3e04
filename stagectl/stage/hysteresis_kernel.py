"""The generalized Prandtl-Ishlinskii model sample by sample, and its inverse by a root of one monotone equation."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed

# `plays` (plays, 2): thresholds and weights; `memory` (plays + 1,): where each play stands, and x.  `shape` (SHAPE,):
# lowest and highest voltage, the coefficients of 1, x, x^2, x^3, and those of x^2 and x^3 in the rising and falling
# envelopes.

LOW, HIGH, OFFSET, CUBIC, RISING, FALLING, SHAPE = 0, 1, 2, 3, 6, 8, 10
ITERATIONS = 60
TOLERANCE = 1e-10
"""Of x, which covers -1 to 1: the last of Newton's steps is no longer; bisection alone would take 34."""


@njit(cache=True, nogil=True)
def reset(voltage: float, shape: np.ndarray, memory: np.ndarray) -> None:
    """Put every play where it stands after long cycles that died away about `voltage`."""
    x = _inside(voltage, shape)
    memory[-1] = x
    for i in range(memory.shape[0] - 1):
        memory[i] = 0.5 * (_envelope(x, shape, RISING) + _envelope(x, shape, FALLING))


@njit(cache=True, nogil=True)
def respond(
    voltage: np.ndarray, response: np.ndarray, shape: np.ndarray, plays: np.ndarray, memory: np.ndarray
) -> None:
    """Fill `response` (m) from `voltage` (V), (samples,) both, and move the plays."""
    for n in range(voltage.shape[0]):
        x = _inside(voltage[n], shape)
        response[n], _ = _value(x, shape, plays, memory)
        _move(x, shape, plays, memory)


@njit(cache=True, nogil=True)
def play(voltage: np.ndarray, shape: np.ndarray, plays: np.ndarray, memory: np.ndarray, moved: np.ndarray) -> None:
    """Fill `moved` (plays, samples) with where the plays stand under `voltage` (samples,), V."""
    for n in range(voltage.shape[0]):
        _move(_inside(voltage[n], shape), shape, plays, memory)
        moved[:, n] = memory[:-1]


@njit(cache=True, nogil=True)
def invert(wanted: np.ndarray, voltage: np.ndarray, shape: np.ndarray, plays: np.ndarray, memory: np.ndarray) -> None:
    """Fill `voltage` (V), the nearest within its range, from the response `wanted` (m), and move the plays."""
    for n in range(wanted.shape[0]):
        voltage[n] = invert_one(wanted[n], shape, plays, memory)


@njit(cache=True, nogil=True)
def invert_one(wanted: float, shape: np.ndarray, plays: np.ndarray, memory: np.ndarray) -> float:
    """Return the voltage that makes the response `wanted`, V, and move the plays; NaN for NaN, moving nothing."""
    if np.isnan(wanted):
        return wanted
    x, low, high = memory[-1], -2.0, 2.0
    for _ in range(ITERATIONS):
        value, slope = _value(x, shape, plays, memory)
        if value > wanted:
            high = x
        else:
            low = x
        following = min(max(x + (wanted - value) / slope, -1.0), 1.0)
        if not low < following < high:
            following = 0.5 * (max(low, -1.0) + min(high, 1.0))
        step = following - x
        x = following
        if abs(step) <= TOLERANCE:
            break
    _move(x, shape, plays, memory)
    voltage: float = shape[LOW] + 0.5 * (x + 1.0) * (shape[HIGH] - shape[LOW])
    return voltage


@njit(cache=True, nogil=True)
def lag(signal: np.ndarray, pole: float) -> None:
    """Let `signal` (samples,) lag behind itself by a first-order pole, at rest where it starts, in place."""
    for n in range(1, signal.shape[0]):
        signal[n] = flushed(pole * signal[n - 1] + (1.0 - pole) * signal[n])


@njit(cache=True, nogil=True)
def compensate(
    asked: np.ndarray, voltage: np.ndarray, on: np.ndarray, shapes: np.ndarray, plays: np.ndarray, memory: np.ndarray
) -> None:
    """Fill `voltage` (frames, width) so that a modelled actuator goes along its chord over `asked`, V both.

    `on` (width,) says where; `shapes` (width, SHAPE + 2) end in the responses at both ends of the chord.
    """
    for axis in range(asked.shape[1]):
        if not on[axis]:
            for n in range(asked.shape[0]):
                voltage[n, axis] = asked[n, axis]
            continue
        shape = shapes[axis]
        slope = (shape[SHAPE + 1] - shape[SHAPE]) / (shape[HIGH] - shape[LOW])
        for n in range(asked.shape[0]):
            wanted = shape[SHAPE] + slope * (asked[n, axis] - shape[LOW])
            voltage[n, axis] = invert_one(wanted, shape, plays[axis], memory[axis])


@njit(cache=True, nogil=True)
def _inside(voltage: float, shape: np.ndarray) -> float:
    """Return x, -1 to 1 over the range of voltage; beyond, the nearer end."""
    x: float = 2.0 * (voltage - shape[LOW]) / (shape[HIGH] - shape[LOW]) - 1.0
    return min(max(x, -1.0), 1.0)


@njit(cache=True, nogil=True)
def _envelope(x: float, shape: np.ndarray, side: int) -> float:
    curve: float = x + x * x * (shape[side] + x * shape[side + 1])
    return curve


@njit(cache=True, nogil=True)
def _value(x: float, shape: np.ndarray, plays: np.ndarray, memory: np.ndarray) -> tuple[float, float]:
    """Return the response to x, m, and its slope, from where the plays stand."""
    value = shape[OFFSET] + x * (shape[CUBIC] + x * (shape[CUBIC + 1] + x * shape[CUBIC + 2]))
    slope = shape[CUBIC] + x * (2.0 * shape[CUBIC + 1] + x * 3.0 * shape[CUBIC + 2])
    up, down = _envelope(x, shape, RISING), _envelope(x, shape, FALLING)
    steep_up = 1.0 + x * (2.0 * shape[RISING] + x * 3.0 * shape[RISING + 1])
    steep_down = 1.0 + x * (2.0 * shape[FALLING] + x * 3.0 * shape[FALLING + 1])
    for i in range(plays.shape[0]):
        threshold, weight = plays[i, 0], plays[i, 1]
        stands, steep = memory[i], 0.0
        if down + threshold < stands:
            stands, steep = down + threshold, steep_down
        if up - threshold > stands:
            stands, steep = up - threshold, steep_up
        value += weight * stands
        slope += weight * steep
    return value, slope


@njit(cache=True, nogil=True)
def _move(x: float, shape: np.ndarray, plays: np.ndarray, memory: np.ndarray) -> None:
    up, down = _envelope(x, shape, RISING), _envelope(x, shape, FALLING)
    memory[-1] = x
    for i in range(plays.shape[0]):
        memory[i] = max(up - plays[i, 0], min(down + plays[i, 0], memory[i]))
