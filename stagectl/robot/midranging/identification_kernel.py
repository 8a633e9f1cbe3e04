"""The compiled search for a loop's dead time: models with every one that is tried, estimated side by side."""

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record
from stagectl.robot.midranging import least_squares_kernel as squares
from stagectl.robot.midranging import loop_model_kernel as model

BETTER = 0.95
"""A longer dead time is taken where the mean square of its error is less than this share of a shorter one's."""
ALLOWED, LEAST = 4.0, 0.35
"""Residuals that the alarm takes as usual: so many times the mean square that the model's form left while it was
estimated, and at least what an input gain off by this share leaves."""

DEAFEST = 4.0
"""Times that, where the alarm rings again and again."""


@njit(cache=True, nogil=True)
def watch(loop: Record, order: int, keep: float, measured: float) -> None:
    """Estimate every candidate from the output measured now, m, and see how far its own output is off."""
    for number in range(loop.candidates):
        candidate = loop.bank[number]
        if squares.observe(candidate.squares, order, measured) and model.is_usable(candidate.squares.estimate, order):
            for row in range(2 * order):
                candidate.model.used[row] = candidate.squares.estimate[row]
        modelled = model.output(candidate.model, order)
        model.push(candidate.model.outputs, modelled)
        error = measured - modelled
        candidate.error_power = flushed(keep * candidate.error_power + (1.0 - keep) * error * error)


@njit(cache=True, nogil=True)
def apply(loop: Record) -> None:
    """Give every candidate what the loop was given, its dead time later."""
    for number in range(loop.candidates):
        candidate = loop.bank[number]
        value = model.delayed(loop.inputs_line, loop.at, candidate.delay)
        model.push(candidate.model.inputs, value)
        squares.apply(candidate.squares, value)


@njit(cache=True, nogil=True)
def best(loop: Record) -> int:
    """Return which candidate is the nearest."""
    chosen = 0
    for number in range(1, loop.candidates):
        if loop.bank[number].error_power < BETTER * loop.bank[chosen].error_power:
            chosen = number
    return chosen


@njit(cache=True, nogil=True)
def choose(loop: Record, order: int, chosen: int) -> None:
    """Use a candidate from now on, its estimate and its covariance; how the estimator forgets stays the loop's own."""
    candidate, own = loop.bank[chosen], loop.squares
    own.outputs[:] = candidate.squares.outputs
    own.inputs[:] = candidate.squares.inputs
    own.slow_input = candidate.squares.slow_input
    own.activity, own.alarm = candidate.squares.activity, 0.0
    left = max(candidate.squares.residual_power - 2.0 * own.variance, 0.0)
    own.relative = max(ALLOWED * left / max(candidate.squares.activity_power, 1e-300), (LEAST * (1.0 - own.pole)) ** 2)
    own.most = DEAFEST * own.relative
    loop.chosen, loop.delay = chosen, candidate.delay
    recall(loop, order)


@njit(cache=True, nogil=True)
def recall(loop: Record, order: int) -> None:
    """Use the model that was chosen, and its covariance, as the estimation phase has left them."""
    candidate, own = loop.bank[loop.chosen], loop.squares
    own.estimate[:] = candidate.squares.estimate
    own.factors[:] = candidate.squares.factors
    own.estimate[: 2 * order] = candidate.model.used[: 2 * order]
    model.adopt(loop, order)
