"""The compiled kernel of adaptive internal model control: every axis, a sample at a time.

Numba's cache looks at the date of this file alone: change it with the kernels that it is made of.
"""

import math

from numba import njit

from rigkit.flush_kernel import flushed
from stagectl.robot.midranging import least_squares_kernel as squares
from stagectl.robot.midranging import loop_model_kernel as loop
from stagectl.robot.midranging import reference_governor_kernel as governor

FAST, SLOW = 0, 1
ESTIMATING, ACTIVE = 0.0, 1.0
PHASE, COUNT, REFERENCE, DISTURBANCE, BLIND, CELLS = range(6)
"""Of `phase`, a row an axis: last reference and last d that were numbers, m; samples in which something was none."""
MIDDLE, LEAST_SAMPLES, ACCURACY, NOISE, FORGET, AMPLITUDE, HALF_PERIOD = 0, 1, 2, 3, 5, 6, 8
SETTINGS = 10
"""Of `settings`: m; samples; 1, squared; m^2 of either loop; 1; m and samples of either loop."""


@njit(cache=True, nogil=True)
def _excitation(settings, which, count):  # type: ignore[no-untyped-def]
    """Return the square wave of the estimation phase, m; its first half is half as long."""
    half = settings[HALF_PERIOD + which]
    sign = 1.0 if int((count + 0.5 * half) // half) % 2 == 0 else -1.0
    return sign * settings[AMPLITUDE + which]


@njit(cache=True, nogil=True)
def _is_accurate(model, settings, which):  # type: ignore[no-untyped-def]
    """Whether the model's own output has followed the measured one, but for noise."""
    allowed = settings[ACCURACY] * model[loop.OUTPUT_POWER] + 2.0 * settings[NOISE + which]
    return model[loop.ERROR_POWER] <= allowed


@njit(cache=True, nogil=True)
def _watch(model, settings, measured, modelled):  # type: ignore[no-untyped-def]
    keep = settings[FORGET]
    error = measured - modelled
    model[loop.ERROR_POWER] = flushed(keep * model[loop.ERROR_POWER] + (1.0 - keep) * error * error)
    model[loop.OUTPUT_POWER] = flushed(keep * model[loop.OUTPUT_POWER] + (1.0 - keep) * measured * measured)


@njit(cache=True, nogil=True)
def _learn(model, memory, settings, order, measured):  # type: ignore[no-untyped-def]
    """Update one loop's estimate, and its model where that changed; return the model's output now."""
    if squares.observe(memory, settings, order, measured):
        loop.adopt(model, memory, order)
    return loop.output(model, order)


@njit(cache=True, nogil=True)
def _fill(seen, state, models, order):  # type: ignore[no-untyped-def]
    """Return the positions, the models' where they are no numbers, and keep the reference if that is one."""
    reference, relative, fast, slow = seen
    if not math.isfinite(reference + relative + fast + slow):
        state[BLIND] += 1.0
    if math.isfinite(reference):
        state[REFERENCE] = reference
    fast = fast if math.isfinite(fast) else loop.output(models[FAST], order)
    slow = slow if math.isfinite(slow) else loop.output(models[SLOW], order)
    return fast, slow


@njit(cache=True, nogil=True)
def _control(models, wanted, order, error):  # type: ignore[no-untyped-def]
    """Return the references of the fast loop, not yet governed, and the slow one: C_f e and C_s e, m."""
    both = loop.desired(wanted[FAST], error, order)
    slow = loop.desired(wanted[SLOW], error, order)
    return loop.invert(models[FAST], order, both - slow), loop.invert(models[SLOW], order, slow)


@njit(cache=True, nogil=True)
def _advance_phase(state, models, settings):  # type: ignore[no-untyped-def]
    """Begin control once the estimation phase has taken its time and both models are accurate."""
    accurate = _is_accurate(models[FAST], settings, FAST) and _is_accurate(models[SLOW], settings, SLOW)
    if state[COUNT] >= settings[LEAST_SAMPLES] and accurate:
        state[PHASE] = ACTIVE


@njit(cache=True, nogil=True)
def _step(seen, order, settings, learning, limits, models, wanted, memory, inner, state):  # type: ignore[no-untyped-def]
    """Do one sample of one axis; return the references of either loop, the fast one about the middle, m.

    `seen`: reference, relative, fast (about the middle) and slow position, m.
    """
    fast, slow = _fill(seen, state, models, order)
    modelled_fast = _learn(models[FAST], memory[FAST], learning[FAST], order, fast)
    modelled_slow = _learn(models[SLOW], memory[SLOW], learning[SLOW], order, slow)
    disturbance = seen[1] - modelled_fast - modelled_slow
    if math.isfinite(disturbance):
        state[DISTURBANCE] = disturbance
    if state[PHASE] == ESTIMATING:
        _watch(models[FAST], settings, fast, modelled_fast)
        _watch(models[SLOW], settings, slow, modelled_slow)
        _advance_phase(state, models, settings)
    if state[PHASE] == ACTIVE:
        error = state[REFERENCE] - state[DISTURBANCE]
        fast_wanted, slow_given = _control(models, wanted, order, error)
    else:
        fast_wanted = _excitation(settings, FAST, state[COUNT])
        slow_given = _excitation(settings, SLOW, state[COUNT])
    state[COUNT] += 1.0
    fast_given = governor.govern(inner, limits, models[FAST], order, fast_wanted, fast)
    for which, modelled, given in ((FAST, modelled_fast, fast_given), (SLOW, modelled_slow, slow_given)):
        loop.push(models[which], loop.OUTPUTS, modelled)
        loop.push(models[which], loop.INPUTS, given)
        squares.apply(memory[which], learning[which], given)
    return fast_given, slow_given


@njit(cache=True, nogil=True)
def run(  # type: ignore[no-untyped-def]
    reference, relative, fast, slow,
    fast_reference, slow_reference, control, share, active, fast_model, slow_model,
    order, settings, learning, limits, models, wanted, memory, inner, phase,
):  # fmt: skip
    """Run one frame: signals are shape (frames, axes), models (frames, axes * 2 order)."""
    for n in range(len(reference)):
        for axis in range(reference.shape[1]):
            middle = settings[axis, MIDDLE]
            seen = reference[n, axis], relative[n, axis], fast[n, axis] - middle, slow[n, axis]
            given, slow_given = _step(
                seen, order, settings[axis], learning[axis], limits[axis],
                models[axis], wanted[axis], memory[axis], inner[axis], phase[axis],
            )  # fmt: skip
            fast_reference[n, axis], slow_reference[n, axis] = given + middle, slow_given
            control[n, axis], share[n, axis] = inner[axis, governor.CONTROL], inner[axis, governor.SHARE]
            active[n, axis] = phase[axis, PHASE]
            for row in range(2 * order):
                fast_model[n, 2 * order * axis + row] = models[axis, FAST, loop.USED + row]
                slow_model[n, 2 * order * axis + row] = models[axis, SLOW, loop.USED + row]
