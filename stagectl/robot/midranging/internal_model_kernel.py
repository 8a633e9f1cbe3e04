"""The compiled kernel of adaptive internal model control: every axis, a sample at a time.

Numba's cache looks at the date of this file alone: change it with the kernels that it is made of.
"""

import math

import numpy as np
from numba import njit

from rigkit.flush_kernel import flushed
from stagectl.robot.midranging import least_squares_kernel as squares
from stagectl.robot.midranging import loop_model_kernel as model
from stagectl.robot.midranging import reference_governor_kernel as governor
from stagectl.robot.midranging.axis_record import ACTIVE, ESTIMATING

Answers = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""`fast_reference`, `slow_reference`, `control`, `share`, `active`, `fast_model` and `slow_model`, as the ports are."""


@njit(cache=True, nogil=True)
def _excitation(loop: np.record, count: int) -> float:
    """Return the square wave of the estimation phase, m; its first half is half as long."""
    sign = 1.0 if int((count + 0.5 * loop.half_period) // loop.half_period) % 2 == 0 else -1.0
    return float(sign * loop.amplitude)


@njit(cache=True, nogil=True)
def _is_accurate(loop: np.record, accuracy: float) -> bool:
    """Whether the model's own output has followed the measured one, but for noise."""
    return bool(loop.error_power <= accuracy * loop.output_power + 2.0 * loop.noise)


@njit(cache=True, nogil=True)
def _watch(loop: np.record, keep: float, measured: float, modelled: float) -> None:
    error = measured - modelled
    loop.error_power = flushed(keep * loop.error_power + (1.0 - keep) * error * error)
    loop.output_power = flushed(keep * loop.output_power + (1.0 - keep) * measured * measured)


@njit(cache=True, nogil=True)
def _learn(loop: np.record, order: int, measured: float) -> float:
    """Update one loop's estimate, and its model where that changed; return the model's output now."""
    if squares.observe(loop.squares, order, measured):
        model.adopt(loop, order)
    return model.output(loop, order)


@njit(cache=True, nogil=True)
def _fill(axis: np.record, seen: tuple[float, float, float, float]) -> tuple[float, float]:
    """Return the positions, the models' where they are no numbers, and keep the reference if that is one."""
    reference, relative, fast, slow = seen
    if not math.isfinite(reference + relative + fast + slow):
        axis.blind += 1
    if math.isfinite(reference):
        axis.reference = reference
    fast = fast if math.isfinite(fast) else model.output(axis.fast, axis.order)
    slow = slow if math.isfinite(slow) else model.output(axis.slow, axis.order)
    return fast, slow


@njit(cache=True, nogil=True)
def _control(axis: np.record, error: float) -> tuple[float, float]:
    """Return the references of the fast loop, not yet governed, and the slow one: C_f e and C_s e, m."""
    order = axis.order
    both = model.desired(axis.fast.wanted, error, order)
    slow = model.desired(axis.slow.wanted, error, order)
    return model.invert(axis.fast, order, both - slow), model.invert(axis.slow, order, slow)


@njit(cache=True, nogil=True)
def _advance_phase(axis: np.record) -> None:
    """Begin control once the estimation phase has taken its time and both models are accurate."""
    accurate = _is_accurate(axis.fast, axis.accuracy) and _is_accurate(axis.slow, axis.accuracy)
    if axis.count >= axis.least_samples and accurate:
        axis.phase = ACTIVE


@njit(cache=True, nogil=True)
def _step(axis: np.record, seen: tuple[float, float, float, float]) -> tuple[float, float]:
    """Do one sample of one axis; return the references of either loop, the fast one about the middle, m.

    `seen`: reference, relative, fast (about the middle) and slow position, m.
    """
    order = axis.order
    fast, slow = _fill(axis, seen)
    modelled_fast, modelled_slow = _learn(axis.fast, order, fast), _learn(axis.slow, order, slow)
    disturbance = seen[1] - modelled_fast - modelled_slow
    if math.isfinite(disturbance):
        axis.disturbance = disturbance
    if axis.phase == ESTIMATING:
        _watch(axis.fast, axis.forget, fast, modelled_fast)
        _watch(axis.slow, axis.forget, slow, modelled_slow)
        _advance_phase(axis)
    if axis.phase == ACTIVE:
        fast_wanted, slow_given = _control(axis, axis.reference - axis.disturbance)
    else:
        fast_wanted, slow_given = _excitation(axis.fast, axis.count), _excitation(axis.slow, axis.count)
    axis.count += 1
    fast_given = governor.govern(axis.governor, axis.fast, order, fast_wanted, fast)
    _apply(axis.fast, modelled_fast, fast_given)
    _apply(axis.slow, modelled_slow, slow_given)
    return fast_given, slow_given


@njit(cache=True, nogil=True)
def _apply(loop: np.record, modelled: float, given: float) -> None:
    """Remember what a loop's model showed and what it is given."""
    model.push(loop.outputs, modelled)
    model.push(loop.inputs, given)
    squares.apply(loop.squares, given)


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
