"""The compiled kernel of recursive least squares, for one loop: filter, gate, update, bound, alarm.

A loop y_k = sum a_i y_{k-i} + sum b_i w_{k-i} is estimated on signals that one low-pass smoothed alike: the noise
of the sensor is white in the output, and so correlated in the unsmoothed equation.  The covariance is kept as factors
U D U' and updated by Bierman's algorithm: it stays positive whatever rounding does, for as long as the loop runs.
"""

from numba import njit

from rigkit.flush_kernel import flushed

ORDER = 3
SIZE = 2 * ORDER
ESTIMATE, FACTORS, OUTPUTS, INPUTS = 0, SIZE, SIZE + SIZE * SIZE, SIZE + SIZE * SIZE + ORDER
"""Of `memory`: parameters; their covariance over the residual's variance, U above the diagonal and D on it; smoothed
outputs and inputs, latest first."""
SLOW_INPUT, ALARM, RESETS, UPDATES = range(INPUTS + ORDER, INPUTS + ORDER + 4)
TURNED, DIRECTION, CELLS = UPDATES + 1, UPDATES + 1 + SIZE, UPDATES + 1 + 2 * SIZE
"""For the time of an update: U' times regressors, covariance times regressors; cells of `memory`."""
FORGETTING, POLE, VARIANCE, START, GATE, DRIFT, LIMIT = range(7)
"""Of `settings`: per update; of the low-pass; m^2 of the residual; of the covariance; m; 1; 1."""


@njit(cache=True, nogil=True)
def reset(memory, settings):  # type: ignore[no-untyped-def]
    """Say that nothing is known of the parameters but their estimate."""
    for row in range(SIZE):
        for column in range(SIZE):
            memory[FACTORS + SIZE * row + column] = settings[START] if row == column else 0.0
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
def _turn(memory, order):  # type: ignore[no-untyped-def]
    """Fill `TURNED`, and return the covariance seen by the regressors."""
    total = 0.0
    for column in range(2 * order):
        turned = _regressor(memory, order, column)
        for row in range(column):
            turned += memory[FACTORS + SIZE * row + column] * _regressor(memory, order, row)
        memory[TURNED + column] = turned
        total += memory[FACTORS + (SIZE + 1) * column] * turned * turned
    return total


@njit(cache=True, nogil=True)
def _update(memory, settings, order, residual):  # type: ignore[no-untyped-def]
    """Do (3.4) [Bierman 1977, ch. V], and scale the covariance down where its trace is above that of the start."""
    forgetting = settings[FORGETTING]
    before = forgetting
    for column in range(2 * order):
        turned, own = memory[TURNED + column], FACTORS + (SIZE + 1) * column
        weighted = memory[own] * turned
        after = before + turned * weighted
        memory[own] *= before / (after * forgetting)
        memory[DIRECTION + column] = weighted
        for row in range(column):
            cell = FACTORS + SIZE * row + column
            factor = memory[cell]
            memory[cell] -= turned / before * memory[DIRECTION + row]
            memory[DIRECTION + row] += weighted * factor
        before = after
    for row in range(2 * order):
        memory[ESTIMATE + row] += memory[DIRECTION + row] * residual / before
    memory[UPDATES] += 1.0
    _bound(memory, settings, order)


@njit(cache=True, nogil=True)
def _bound(memory, settings, order):  # type: ignore[no-untyped-def]
    trace, most = 0.0, 2 * order * settings[START]
    for column in range(2 * order):
        squared = 1.0
        for row in range(column):
            squared += memory[FACTORS + SIZE * row + column] ** 2
        trace += memory[FACTORS + (SIZE + 1) * column] * squared
    if trace > most:
        for column in range(2 * order):
            memory[FACTORS + (SIZE + 1) * column] *= most / trace


@njit(cache=True, nogil=True)
def observe(memory, settings, order, output):  # type: ignore[no-untyped-def]
    """Take one output in, m, and return whether the estimate was updated; `apply` follows with the sample's input."""
    smooth = flushed(settings[POLE] * memory[OUTPUTS] + (1.0 - settings[POLE]) * output)
    updated = abs(memory[INPUTS] - memory[SLOW_INPUT]) >= settings[GATE]
    if updated:
        residual = smooth - _predicted(memory, order)
        surprise = residual * residual / (settings[VARIANCE] * (1.0 + _turn(memory, order)))
        memory[ALARM] = max(0.0, memory[ALARM] + min(surprise, settings[LIMIT]) - settings[DRIFT])
        if memory[ALARM] > settings[LIMIT]:
            reset(memory, settings)
            memory[RESETS] += 1.0
            _turn(memory, order)
        _update(memory, settings, order, residual)
    for row in range(ORDER - 1, 0, -1):
        memory[OUTPUTS + row] = memory[OUTPUTS + row - 1]
    memory[OUTPUTS] = smooth
    return updated


@njit(cache=True, nogil=True)
def apply(memory, settings, value):  # type: ignore[no-untyped-def]
    """Take in what the loop is given this sample, m."""
    smooth = flushed(settings[POLE] * memory[INPUTS] + (1.0 - settings[POLE]) * value)
    for row in range(ORDER - 1, 0, -1):
        memory[INPUTS + row] = memory[INPUTS + row - 1]
    memory[INPUTS] = smooth
    slow = memory[SLOW_INPUT]
    memory[SLOW_INPUT] = flushed(slow + (1.0 - settings[POLE]) * (smooth - slow))
