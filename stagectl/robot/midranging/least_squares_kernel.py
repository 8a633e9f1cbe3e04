"""The compiled kernel of recursive least squares, for one loop: filter, gate, update, bound, alarm.

A loop y_k = sum a_i y_{k-i} + sum b_i w_{k-i} is estimated on signals that one low-pass smoothed alike: the noise
of the sensor is white in the output, and so correlated in the unsmoothed equation.
"""

from numba import njit

ORDER = 3
SIZE = 2 * ORDER
ESTIMATE, COVARIANCE, OUTPUTS, INPUTS = 0, SIZE, SIZE + SIZE * SIZE, SIZE + SIZE * SIZE + ORDER
"""Of `memory`: parameters, their covariance over the residual's variance, smoothed outputs and inputs, latest first."""
SLOW_INPUT, ALARM, RESETS, UPDATES, RESIDUAL = range(INPUTS + ORDER, INPUTS + ORDER + 5)
DIRECTION, CELLS = RESIDUAL + 1, RESIDUAL + 1 + SIZE
"""Covariance times regressors, for the time of an update; cells of `memory`."""
FORGETTING, POLE, VARIANCE, START, GATE, DRIFT, LIMIT = range(7)
"""Of `settings`: per update; of the low-pass; m^2 of the residual; of the covariance; m; 1; 1."""


@njit(cache=True, nogil=True)
def reset(memory, settings):  # type: ignore[no-untyped-def]
    """Say that nothing is known of the parameters but their estimate."""
    for row in range(SIZE):
        for column in range(SIZE):
            memory[COVARIANCE + SIZE * row + column] = settings[START] if row == column else 0.0
    memory[ALARM] = 0.0


@njit(cache=True, nogil=True)
def _regressor(memory, order, row):  # type: ignore[no-untyped-def]
    return memory[OUTPUTS + row] if row < order else memory[INPUTS + row - order]


@njit(cache=True, nogil=True)
def _predicted(memory, order):  # type: ignore[no-untyped-def]
    total = 0.0
    for row in range(2 * order):
        total += memory[ESTIMATE + row] * _regressor(memory, order, row)
    return total


@njit(cache=True, nogil=True)
def _project(memory, order):  # type: ignore[no-untyped-def]
    """Fill `DIRECTION` with covariance times regressors, and return the regressors' share of it."""
    total = 0.0
    for row in range(2 * order):
        product = 0.0
        for column in range(2 * order):
            product += memory[COVARIANCE + SIZE * row + column] * _regressor(memory, order, column)
        memory[DIRECTION + row] = product
        total += product * _regressor(memory, order, row)
    return total


@njit(cache=True, nogil=True)
def _update(memory, settings, order, residual, spread):  # type: ignore[no-untyped-def]
    """Do (3.4), and scale the covariance down where its trace is above that of the start."""
    forgetting, trace = settings[FORGETTING], 0.0
    scale = 1.0 / (forgetting + spread)
    for row in range(2 * order):
        memory[ESTIMATE + row] += scale * memory[DIRECTION + row] * residual
        for column in range(row + 1):
            taken = scale * memory[DIRECTION + row] * memory[DIRECTION + column]
            value = (memory[COVARIANCE + SIZE * row + column] - taken) / forgetting
            memory[COVARIANCE + SIZE * row + column] = memory[COVARIANCE + SIZE * column + row] = value
        trace += memory[COVARIANCE + SIZE * row + row]
    most = 2 * order * settings[START]
    if trace > most:
        for cell in range(COVARIANCE, COVARIANCE + SIZE * SIZE):
            memory[cell] *= most / trace
    memory[UPDATES] += 1.0


@njit(cache=True, nogil=True)
def observe(memory, settings, order, output):  # type: ignore[no-untyped-def]
    """Take one output in, m, and return whether the estimate was updated; `apply` follows with the sample's input."""
    smooth = settings[POLE] * memory[OUTPUTS] + (1.0 - settings[POLE]) * output
    updated = abs(memory[INPUTS] - memory[SLOW_INPUT]) >= settings[GATE]
    if updated:
        residual = smooth - _predicted(memory, order)
        spread = _project(memory, order)
        surprise = residual * residual / (settings[VARIANCE] * (1.0 + spread))
        memory[RESIDUAL] = residual
        memory[ALARM] = max(0.0, memory[ALARM] + min(surprise, settings[LIMIT]) - settings[DRIFT])
        if memory[ALARM] > settings[LIMIT]:
            reset(memory, settings)
            memory[RESETS] += 1.0
            spread = _project(memory, order)
        _update(memory, settings, order, residual, spread)
    for row in range(ORDER - 1, 0, -1):
        memory[OUTPUTS + row] = memory[OUTPUTS + row - 1]
    memory[OUTPUTS] = smooth
    return updated


@njit(cache=True, nogil=True)
def apply(memory, settings, value):  # type: ignore[no-untyped-def]
    """Take in what the loop is given this sample, m."""
    smooth = settings[POLE] * memory[INPUTS] + (1.0 - settings[POLE]) * value
    for row in range(ORDER - 1, 0, -1):
        memory[INPUTS + row] = memory[INPUTS + row - 1]
    memory[INPUTS] = smooth
    memory[SLOW_INPUT] += (1.0 - settings[POLE]) * (smooth - memory[SLOW_INPUT])
