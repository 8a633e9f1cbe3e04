"""The compiled kernel of adaptive internal model control: every axis, a sample at a time."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record
from stagectl.robot.midranging import identification_kernel as identification
from stagectl.robot.midranging import least_squares_kernel as squares
from stagectl.robot.midranging import loop_model_kernel as model
from stagectl.robot.midranging import oscillation_kernel as oscillation
from stagectl.robot.midranging import reference_governor_kernel as governor
from stagectl.robot.midranging import supervision_kernel as supervision
from stagectl.robot.midranging import valve_position_kernel as valve
from stagectl.robot.midranging.axis_record import (
    ACTIVE,
    DIVERGING,
    ESTIMATING,
    INACCURATE,
    LINE,
    OSCILLATING,
    TAKEN_OVER,
)

BLIND_TRUST = 0.5
"""Of the control signal's limit, while the model stands for the fast position."""
SMOOTH = 0.3
"""Of what the fast position differs by from its model's, a sample: the noise is 0.42 times as large behind it."""
CAUTION = 1.0
"""Time constant of a robustness filter, over the dead time and the share of the loop's time that its model is off."""
USUAL = 1.0
"""Residuals of the slow loop beyond what is expected are not listened to: a robot's limit of speed makes them."""
LEAD = 2.0
"""Of what is asked of the micro manipulator beyond its travel, how much more the macro one is asked for meanwhile."""
WINDOW = 4.0
"""Of the watch over the models, over the slow loop's dead time and time constant together."""
FAST_MOST, SLOW_MOST, LEAST = 1.5, 1.1, 0.05
"""A model diverges where its error is so many times its output, and so large a share of the travel."""
CAUTIOUS = 0.5
"""Time constant of the fast loop's robustness filter once the error oscillates, over the loop's."""
HALVINGS = 3
"""Of valve position control's gain, at most: a sensor that swings by itself does not end control."""

Answers = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""`fast_reference`, `slow_reference`, `control`, `share`, `active`, `fast_model` and `slow_model`, as the ports are."""


@njit(cache=True, nogil=True)
def _excitation(loop: Record, count: int) -> float:
    """Return the square wave of the estimation phase, m; its first half is half as long."""
    sign = 1.0 if int((count + 0.5 * loop.half_period) // loop.half_period) % 2 == 0 else -1.0
    return float(sign * loop.amplitude)


@njit(cache=True, nogil=True)
def _learn(loop: Record, order: int, measured: float) -> None:
    """Update one loop's estimate, and its model where that changed."""
    if squares.observe(loop.squares, order, measured):
        model.adopt(loop, order)


@njit(cache=True, nogil=True)
def _off(loop: Record, number: int) -> float:
    """Return the mean square of a candidate's error over that of the output, noise apart."""
    error = max(loop.bank[number].error_power - 2.0 * loop.noise, 0.0)
    return float(error / max(loop.output_power - loop.noise, 1e-300))


@njit(cache=True, nogil=True)
def _advance_phase(axis: Record, fast: float, slow: float) -> None:
    """End the estimation phase once it has taken its time and both models are accurate, or no more time is left."""
    for loop, measured in ((axis.fast, fast), (axis.slow, slow)):
        loop.output_power = flushed(axis.forget * loop.output_power + (1.0 - axis.forget) * measured * measured)
        identification.watch(loop, axis.order, axis.forget, measured)
    if axis.count < axis.least_samples:
        return
    fast_best, slow_best = identification.best(axis.fast), identification.best(axis.slow)
    fast_off, slow_off = _off(axis.fast, fast_best), _off(axis.slow, slow_best)
    off = max(fast_off, slow_off)
    if off > axis.accuracy and axis.count < axis.most_samples:
        return
    told = axis.fast.delay
    for loop, chosen, share in ((axis.fast, fast_best, fast_off), (axis.slow, slow_best, slow_off)):
        identification.choose(loop, axis.order, chosen)
        loop.off = math.sqrt(share)
        late = CAUTION * (loop.delay + loop.off * loop.time)
        loop.filter_pole = math.exp(-1.0 / late) if late > 0.0 else 0.0
        loop.window_pole = math.exp(-1.0 / (WINDOW * (axis.slow.bank[slow_best].delay + axis.slow.time)))
        supervision.begin(loop)
    model.be_as_late(axis.fast, axis.order, told)
    axis.slow.squares.usual, axis.slow.squares.limit = USUAL, math.inf
    axis.phase = ACTIVE
    if off > axis.acceptable:
        _take_over(axis, INACCURATE)


@njit(cache=True, nogil=True)
def _take_over(axis: Record, reason: int) -> None:
    """Let valve position control go on from where both references are: nothing jumps."""
    axis.phase, axis.reason = TAKEN_OVER, reason
    control = axis.valve
    control.slow_model = axis.slow_given
    control.fast_integral = axis.fast_given - control.fast_gain * axis.error + control.feed * control.slow_model
    control.slow_integral = axis.slow_given - control.slow_gain * axis.fast_given
    control.fast, control.slow = axis.fast_given, axis.slow_given


@njit(cache=True, nogil=True)
def _bounded(axis: Record, slow: float, whole: float) -> float:
    """Return a slow reference, m, within the travel of where both manipulators are to be together."""
    return float(min(max(slow, whole - axis.governor.travel), whole + axis.governor.travel))


@njit(cache=True, nogil=True)
def _filtered(loop: Record, value: float) -> float:
    """Return the disturbance behind a loop's robustness filter, m."""
    filtered = float(flushed(loop.filter_pole * loop.filtered + (1.0 - loop.filter_pole) * value))
    loop.filtered = filtered
    return filtered


@njit(cache=True, nogil=True)
def _control(axis: Record) -> tuple[float, float]:
    """Return the references of the fast loop, not yet governed, and the slow one, m: (3.2) and (3.3).

    The fast loop is asked for T_f e less what the slow one, by its model and what it was asked, will show by then; what
    of that is beyond the travel leads the slow one.
    """
    order, fast, slow = axis.order, axis.fast, axis.slow
    quick = axis.reference - _filtered(fast, axis.disturbance)
    late = axis.reference - _filtered(slow, axis.disturbance)
    both = model.desired(fast.wanted, quick, order)
    left, travel = both - model.ahead(slow, order, fast.delay + 1, axis.slow_given), axis.governor.travel
    late += LEAD * (left - min(max(left, -travel), travel))
    slow_given = model.invert(slow, order, model.desired(slow.wanted, late, order))
    slow_given = _bounded(axis, slow_given, axis.reference - axis.outside)
    target = both - model.ahead(slow, order, fast.delay + 1, slow_given)
    return model.invert(fast, order, target), slow_given


@njit(cache=True, nogil=True)
def _valve(axis: Record, error: float) -> tuple[float, float]:
    """Return both references of valve position control, whose slow integral stops at the bound."""
    control = axis.valve
    valve.step(control, error, 0.0)
    given = _bounded(axis, control.slow, axis.reference - axis.outside)
    control.slow_integral += given - control.slow
    return float(control.fast), given


@njit(cache=True, nogil=True)
def _look(axis: Record, seen: tuple[float, float, float, float]) -> tuple[float, float]:
    """Keep what is a number of a sample; return both positions, the models' where they are no numbers."""
    reference, relative, fast, slow = seen
    if not math.isfinite(reference + relative + fast + slow):
        axis.blind += 1
    if math.isfinite(reference):
        axis.reference = reference
    modelled_fast, modelled_slow = model.shown(axis.fast, axis.order), model.shown(axis.slow, axis.order)
    if math.isfinite(relative):
        axis.disturbance, axis.error = relative - modelled_fast - modelled_slow, axis.reference - relative
    if math.isfinite(relative + fast + slow):
        axis.outside = relative - fast - slow
    axis.governor.trust = 1.0 if math.isfinite(fast) else BLIND_TRUST
    if math.isfinite(fast):
        axis.governor.offset += SMOOTH * (fast - modelled_fast - axis.governor.offset)
    return fast if math.isfinite(fast) else modelled_fast + axis.governor.offset, slow if math.isfinite(
        slow
    ) else modelled_slow


@njit(cache=True, nogil=True)
def _supervise(axis: Record, fast: float, slow: float) -> None:
    """Answer to a model that diverges, and to an error that goes on oscillating: with caution, then by taking over."""
    least, order = LEAST * axis.governor.travel, axis.order
    if not math.isfinite(least):
        least = 0.0
    is_off = supervision.is_diverging(axis.fast, FAST_MOST, least, fast, model.shown(axis.fast, order))
    if supervision.is_diverging(axis.slow, SLOW_MOST, least, slow, model.shown(axis.slow, order)) or is_off:
        _take_over(axis, DIVERGING)
        return
    called = axis.reference - axis.outside
    is_small = oscillation.is_oscillating(axis.ripple, axis.error, called)
    is_large = oscillation.is_oscillating(axis.swing, axis.error, called)
    if is_small and not axis.cautious:
        _be_cautious(axis)
        oscillation.begin(axis.swing)
    elif is_large:
        _take_over(axis, OSCILLATING)
        oscillation.begin(axis.swing)


@njit(cache=True, nogil=True)
def _be_cautious(axis: Record) -> None:
    """Go back to the fast model of the estimation phase, which starts anew no more, and feed back less of its error."""
    fast = axis.fast
    identification.recall(fast, axis.order)
    fast.squares.limit = math.inf
    fast.filter_pole = max(fast.filter_pole, math.exp(-1.0 / (CAUTIOUS * fast.time)))
    axis.cautious = 1


@njit(cache=True, nogil=True)
def _relax(axis: Record) -> None:
    """Halve the gain of valve position control where that oscillates as well; neither reference jumps."""
    swing, control = axis.swing, axis.valve
    if oscillation.is_oscillating(swing, axis.error, axis.reference - axis.outside) and swing.halved < HALVINGS:
        swing.halved += 1
        control.fast_gain, control.fast_rate = 0.5 * control.fast_gain, 0.5 * control.fast_rate
        control.fast_integral += control.fast_gain * axis.error
        oscillation.begin(swing)


@njit(cache=True, nogil=True)
def _step(axis: Record, seen: tuple[float, float, float, float]) -> tuple[float, float]:
    """Do one sample of one axis; return the references of either loop, the fast one about the middle, m.

    `seen`: reference, relative, fast (about the middle) and slow position, m.
    """
    order = axis.order
    fast, slow = _look(axis, seen)
    if axis.phase == ESTIMATING:
        _advance_phase(axis, fast, slow)
    elif axis.phase == ACTIVE:
        _learn(axis.fast, order, fast)
        _learn(axis.slow, order, slow)
        _supervise(axis, fast, slow)
    else:
        _relax(axis)
    if axis.phase == ESTIMATING:
        fast_wanted, slow_given = _excitation(axis.fast, axis.count), _excitation(axis.slow, axis.count)
    elif axis.phase == ACTIVE:
        fast_wanted, slow_given = _control(axis)
    else:
        fast_wanted, slow_given = _valve(axis, seen[0] - seen[1])
    axis.count += 1
    modelled = model.shown(axis.fast, order)
    position = governor.position(axis.governor, fast, modelled)
    undelayed = fast + model.output(axis.fast, order) - modelled
    fast_given = governor.govern(axis.governor, axis.fast, order, fast_wanted, position, undelayed)
    if axis.phase == TAKEN_OVER:
        axis.valve.fast_integral += axis.tracking * (fast_given - fast_wanted)
    axis.fast_given, axis.slow_given = fast_given, slow_given
    _apply(axis, axis.fast, fast_given)
    _apply(axis, axis.slow, slow_given)
    return fast_given, slow_given


@njit(cache=True, nogil=True)
def _apply(axis: Record, loop: Record, given: float) -> None:
    """Remember what a loop's model showed and what it is given."""
    modelled = model.output(loop, axis.order)
    model.push(loop.outputs, modelled)
    model.push(loop.inputs, given)
    at = int((loop.at + 1) % LINE)
    loop.at = at
    loop.outputs_line[at], loop.inputs_line[at] = loop.outputs[0], flushed(given)
    if axis.phase == ESTIMATING:
        identification.apply(loop)
    else:
        squares.apply(loop.squares, model.delayed(loop.inputs_line, at, loop.delay))


@njit(cache=True, nogil=True)
def run(
    reference: np.ndarray,
    relative: np.ndarray,
    fast: np.ndarray,
    slow: np.ndarray,
    made: Answers,
    axes: np.ndarray,
) -> None:
    """Run one frame: signals are shape (frames, axes), `axes` records of `AXIS`."""
    fast_reference, slow_reference, control, share, active, fast_model, slow_model = made
    for n in range(len(reference)):
        for number in range(axes.size):
            axis = axes[number]
            seen = reference[n, number], relative[n, number], fast[n, number] - axis.middle, slow[n, number]
            given, slow_given = _step(axis, seen)
            fast_reference[n, number], slow_reference[n, number] = given + axis.middle, slow_given
            control[n, number], share[n, number] = axis.governor.control, axis.governor.share
            active[n, number] = axis.phase
            width = 2 * axis.order
            for row in range(width):
                fast_model[n, width * number + row] = axis.fast.used[row]
                slow_model[n, width * number + row] = axis.slow.used[row]
