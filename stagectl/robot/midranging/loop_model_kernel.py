"""Compiled pieces of one loop's internal model: its output, its inverse, and the check before an estimate is used."""

from numba import njit

from rigkit.flush_kernel import flushed
from stagectl.robot.midranging.least_squares_kernel import ESTIMATE, ORDER
from stagectl.robot.midranging.minimum_phase import mirror

USED, OUTPUTS, INPUTS, INVERSE_OUTPUTS, INVERSE_INPUTS, MIRRORED = (ORDER * each for each in (0, 2, 3, 4, 5, 6))
"""Of `model`: parameters in use, past outputs and inputs of the model, of its inverse, and its numerator mirrored."""
ERROR_POWER, OUTPUT_POWER, REFUSED = range(ORDER * 7, ORDER * 7 + 3)
CELLS = ORDER * 7 + 3
RADIUS = 0.9995
"""Poles of a model in use lie within."""
GAIN = (0.5, 2.0)
"""Its gain at rest lies within: a position loop's is one."""


@njit(cache=True, nogil=True)
def is_usable(estimate, first, order):  # type: ignore[no-untyped-def]
    """Whether poles and gain at rest are within their bounds (Schur and Cohn's recursion on 1 - sum a_i z^-i)."""
    a = 1.0
    total_a, total_b = 1.0, 0.0
    c1 = c2 = c3 = 0.0
    scale = 1.0
    for row in range(order):
        scale /= RADIUS
        value = -estimate[first + row] * scale
        if row == 0:
            c1 = value
        elif row == 1:
            c2 = value
        else:
            c3 = value
        total_a -= estimate[first + row]
        total_b += estimate[first + order + row]
    if order == 3:
        if not abs(c3) < a:
            return False
        a, c1, c2 = a - c3 * c3, c1 - c3 * c2, c2 - c3 * c1
    if order >= 2:
        if not abs(c2) < a:
            return False
        a, c1 = a * a - c2 * c2, c1 * a - c2 * c1
    return abs(c1) < a and GAIN[0] * total_a <= total_b <= GAIN[1] * total_a


@njit(cache=True, nogil=True)
def adopt(model, memory, order):  # type: ignore[no-untyped-def]
    """Use the estimate in `memory` if that may be; else go on with the last one."""
    if not is_usable(memory, ESTIMATE, order):
        model[REFUSED] += 1.0
        return
    for row in range(2 * order):
        model[USED + row] = memory[ESTIMATE + row]
    for row in range(order):
        model[MIRRORED + row] = model[USED + order + row]
    mirror(model, MIRRORED, order)


@njit(cache=True, nogil=True)
def output(model, order):  # type: ignore[no-untyped-def]
    """Return the model's output now, m."""
    total = 0.0
    for row in range(order):
        total += model[USED + row] * model[OUTPUTS + row] + model[USED + order + row] * model[INPUTS + row]
    return total


@njit(cache=True, nogil=True)
def push(model, first, value):  # type: ignore[no-untyped-def]
    """Put a value before the others of its kind."""
    for row in range(ORDER - 1, 0, -1):
        model[first + row] = model[first + row - 1]
    model[first] = flushed(value)


@njit(cache=True, nogil=True)
def invert(model, order, wanted):  # type: ignore[no-untyped-def]
    """Return what the loop must be given now for its output to be `wanted` one sample later, m."""
    total = wanted
    for row in range(order):
        total -= model[USED + row] * model[INVERSE_INPUTS + row]
    for row in range(1, order):
        total -= model[MIRRORED + row] * model[INVERSE_OUTPUTS + row - 1]
    value = total / model[MIRRORED]
    push(model, INVERSE_INPUTS, wanted)
    push(model, INVERSE_OUTPUTS, value)
    return value


@njit(cache=True, nogil=True)
def desired(wanted, error, order):  # type: ignore[no-untyped-def]
    """Return what the desired response makes of `error` one sample later, m; `wanted` is laid out like a model."""
    push(wanted, INPUTS, error)
    value = output(wanted, order)
    push(wanted, OUTPUTS, value)
    return value
