"""Compiled pieces of one loop's internal model: its output, its inverse, and the check before an estimate is used."""

import numpy as np
from numba import njit

from rigkit.flush_kernel import flushed
from stagectl.robot.midranging.axis_record import ORDER
from stagectl.robot.midranging.minimum_phase_kernel import mirror

RADIUS = 0.9995
"""Poles of a model in use lie within."""
GAIN = (0.5, 2.0)
"""Its gain at rest lies within: a position loop's is one."""


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
def adopt(loop: np.record, order: int) -> None:
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
def output(model: np.record, order: int) -> float:
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
def invert(loop: np.record, order: int, wanted: float) -> float:
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
def desired(wanted: np.record, error: float, order: int) -> float:
    """Return what the desired response makes of `error` one sample later, m."""
    push(wanted.inputs, error)
    value = output(wanted, order)
    push(wanted.outputs, value)
    return value
