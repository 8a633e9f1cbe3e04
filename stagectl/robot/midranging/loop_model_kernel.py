"""Compiled pieces of one loop's internal model: its output, its inverse, and the check before an estimate is used."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record
from stagectl.robot.midranging.axis_record import LINE, ORDER
from stagectl.robot.midranging.minimum_phase_kernel import mirror

RADIUS = 0.9995
"""Poles of a model in use lie within."""
GAIN = (0.5, 2.0)
"""Its gain at rest lies within: a position loop's is one."""
SHORTEST = 0.5
"""Of the time constant of a desired response, what is left of it behind any dead time."""


@njit(cache=True, nogil=True)
def is_usable(estimate: np.ndarray, order: int) -> bool:
    """Whether poles and gain at rest are within their bounds (Schur and Cohn's recursion on 1 - sum a_i z^-i)."""
    a = 1.0
    total_a, total_b = 1.0, 0.0
    c1 = c2 = c3 = 0.0
    scale = 1.0
    for row in range(order):
        scale /= RADIUS
        value = -estimate[row] * scale
        if row == 0:
            c1 = value
        elif row == 1:
            c2 = value
        else:
            c3 = value
        total_a -= estimate[row]
        total_b += estimate[order + row]
    if order == 3:
        if not abs(c3) < a:
            return False
        a, c1, c2 = a - c3 * c3, c1 - c3 * c2, c2 - c3 * c1
    if order >= 2:
        if not abs(c2) < a:
            return False
        a, c1 = a * a - c2 * c2, c1 * a - c2 * c1
    return bool(abs(c1) < a and GAIN[0] * total_a <= total_b <= GAIN[1] * total_a)


@njit(cache=True, nogil=True)
def adopt(loop: Record, order: int) -> None:
    """Use the estimate if that may be; else go on with the last one."""
    estimate = loop.squares.estimate
    if not is_usable(estimate, order):
        loop.refused += 1
        return
    for row in range(2 * order):
        loop.used[row] = estimate[row]
    for row in range(order):
        loop.mirrored[row] = loop.used[order + row]
    mirror(loop.mirrored, order)


@njit(cache=True, nogil=True)
def output(model: Record, order: int) -> float:
    """Return the output of a `LOOP` or a `RESPONSE` now, m."""
    total = 0.0
    for row in range(order):
        total += model.used[row] * model.outputs[row] + model.used[order + row] * model.inputs[row]
    return total


@njit(cache=True, nogil=True)
def push(values: np.ndarray, value: float) -> None:
    """Put a value before the others of its kind."""
    for row in range(ORDER - 1, 0, -1):
        values[row] = values[row - 1]
    values[0] = flushed(value)


@njit(cache=True, nogil=True)
def invert(loop: Record, order: int, wanted: float) -> float:
    """Return what the loop must be given now for its output to be `wanted` one sample later, m."""
    total = wanted
    for row in range(order):
        total -= loop.used[row] * loop.inverse_inputs[row]
    for row in range(1, order):
        total -= loop.mirrored[row] * loop.inverse_outputs[row - 1]
    value = total / loop.mirrored[0]
    push(loop.inverse_inputs, wanted)
    push(loop.inverse_outputs, value)
    return float(value)


@njit(cache=True, nogil=True)
def desired(wanted: Record, error: float, order: int) -> float:
    """Return what the desired response makes of `error` one sample later, m."""
    push(wanted.inputs, error)
    value = output(wanted, order)
    push(wanted.outputs, value)
    return value


@njit(cache=True, nogil=True)
def be_as_late(loop: Record, order: int, told: int) -> None:
    """Take a dead time that was found, beyond the one `told` (samples), off the desired response's time constant.

    Dead time and time constant together stay what was asked for.  A desired response of higher order stays.
    """
    whole = loop.wanted_time
    if loop.delay <= told or whole == 0.0:
        return
    time = max(whole + told - loop.delay, SHORTEST * whole)
    loop.wanted.used[:] = 0.0
    loop.wanted.used[0] = math.exp(-1.0 / time)
    loop.wanted.used[order] = 1.0 - loop.wanted.used[0]


@njit(cache=True, nogil=True)
def delayed(line: np.ndarray, at: int, delay: int) -> float:
    """Return what was put into a line `delay` samples before the newest, at `at`."""
    return float(line[(at - delay) % LINE])


@njit(cache=True, nogil=True)
def shown(loop: Record, order: int) -> float:
    """Return the model's output now behind its dead time, m."""
    if loop.delay == 0:
        return output(loop, order)
    return delayed(loop.outputs_line, loop.at, loop.delay - 1)


@njit(cache=True, nogil=True)
def ahead(loop: Record, order: int, samples: int, held: float) -> float:
    """Return the model's output so many `samples` from now (>= 1), with its input `held` (m) from now on."""
    known = samples - loop.delay
    if known < 0:
        return delayed(loop.outputs_line, loop.at, -known - 1)
    o1, o2, o3 = output(loop, order), loop.outputs[0], loop.outputs[1]
    i2, i3 = loop.inputs[0], loop.inputs[1]
    used = loop.used
    for _ in range(known):
        new = used[0] * o1 + used[order] * held
        if order > 1:
            new += used[1] * o2 + used[order + 1] * i2
        if order > 2:
            new += used[2] * o3 + used[order + 2] * i3
        o1, o2, o3 = new, o1, o2
        i2, i3 = held, i2
    return float(o1)
