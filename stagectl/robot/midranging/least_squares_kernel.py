"""The compiled kernel of recursive least squares, for one loop: filter, gate, update, bound, alarm.

A loop y_k = sum a_i y_{k-i} + sum b_i w_{k-i} is estimated on signals that one low-pass smoothed alike: the noise
of the sensor is white in the output, and so correlated in the unsmoothed equation.  The covariance is kept as factors
U D U' and updated by Bierman's algorithm: it stays positive whatever rounding does, for as long as the loop runs.
"""

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record
from stagectl.robot.midranging.axis_record import ORDER, SIZE

AGAIN = 2.0
"""How much more of a residual is the model's form where the alarm rings again within the memory of the mean squares: a
change of the loop would have been learnt by then."""


@njit(cache=True, nogil=True)
def reset(squares: Record) -> None:
    """Say that nothing is known of the parameters but their estimate."""
    for row in range(SIZE):
        for column in range(SIZE):
            squares.factors[row, column] = squares.start if row == column else 0.0
    squares.alarm = 0.0


@njit(cache=True, nogil=True)
def _regressor(squares: Record, order: int, row: int) -> float:
    return float(squares.outputs[row] if row < order else squares.inputs[row - order])


@njit(cache=True, nogil=True)
def _predicted(squares: Record, order: int) -> float:
    total = 0.0
    for row in range(2 * order):
        total += squares.estimate[row] * _regressor(squares, order, row)
    return total


@njit(cache=True, nogil=True)
def _turn(squares: Record, order: int) -> float:
    """Fill `turned`, and return the covariance seen by the regressors."""
    total = 0.0
    for column in range(2 * order):
        turned = _regressor(squares, order, column)
        for row in range(column):
            turned += squares.factors[row, column] * _regressor(squares, order, row)
        squares.turned[column] = turned
        total += squares.factors[column, column] * turned * turned
    return total


@njit(cache=True, nogil=True)
def _update(squares: Record, order: int, residual: float) -> None:
    """Do (3.4) [Bierman 1977, ch. V], and scale the covariance down where its trace is above that of the start."""
    forgetting = squares.forgetting
    before = forgetting
    for column in range(2 * order):
        turned = squares.turned[column]
        weighted = squares.factors[column, column] * turned
        after = before + turned * weighted
        squares.factors[column, column] *= before / (after * forgetting)
        squares.direction[column] = weighted
        for row in range(column):
            factor = squares.factors[row, column]
            squares.factors[row, column] -= turned / before * squares.direction[row]
            squares.direction[row] += weighted * factor
        before = after
    for row in range(2 * order):
        squares.estimate[row] += squares.direction[row] * residual / before
    squares.updates += 1
    _bound(squares, order)


@njit(cache=True, nogil=True)
def _bound(squares: Record, order: int) -> None:
    trace, most = 0.0, 2 * order * squares.start
    for column in range(2 * order):
        squared = 1.0
        for row in range(column):
            squared += squares.factors[row, column] ** 2
        trace += squares.factors[column, column] * squared
    if trace > most:
        for column in range(2 * order):
            squares.factors[column, column] *= most / trace


@njit(cache=True, nogil=True)
def observe(squares: Record, order: int, output: float) -> bool:
    """Take one output in, m, and return whether the estimate was updated; `apply` follows with the sample's input."""
    smooth = flushed(squares.pole * squares.outputs[0] + (1.0 - squares.pole) * output)
    updated = abs(squares.inputs[0] - squares.slow_input) >= squares.gate
    residual = smooth - _predicted(squares, order)
    expected = squares.variance + squares.relative * squares.activity
    updated = updated and residual * residual <= squares.usual * expected
    if updated:
        surprise = residual * residual / (expected * (1.0 + _turn(squares, order)))
        squares.alarm = max(0.0, squares.alarm + min(surprise, squares.limit) - squares.drift)
        squares.calm += 1
        if squares.alarm > squares.limit:
            if squares.resets > 0 and squares.calm * (1.0 - squares.keep) < 1.0:
                squares.relative = min(AGAIN * squares.relative, squares.most)
            squares.calm = 0
            reset(squares)
            squares.resets += 1
            _turn(squares, order)
        _update(squares, order, residual)
        keep = squares.keep
        squares.residual_power = flushed(keep * squares.residual_power + (1.0 - keep) * residual * residual)
        squares.activity_power = flushed(keep * squares.activity_power + (1.0 - keep) * squares.activity)
    for row in range(ORDER - 1, 0, -1):
        squares.outputs[row] = squares.outputs[row - 1]
    squares.outputs[0] = smooth
    return bool(updated)


@njit(cache=True, nogil=True)
def apply(squares: Record, value: float) -> None:
    """Take in what the loop is given this sample, m."""
    smooth = flushed(squares.pole * squares.inputs[0] + (1.0 - squares.pole) * value)
    for row in range(ORDER - 1, 0, -1):
        squares.inputs[row] = squares.inputs[row - 1]
    squares.inputs[0] = smooth
    slow = squares.slow_input
    squares.slow_input = flushed(slow + (1.0 - squares.pole) * (smooth - slow))
    active = (squares.inputs[0] - squares.slow_input) ** 2
    squares.activity = flushed(squares.pole * squares.activity + (1.0 - squares.pole) * active)
