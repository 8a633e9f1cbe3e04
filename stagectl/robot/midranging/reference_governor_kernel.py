"""The compiled governor of one axis: the inner control signal and the travel, kept within their limits."""

from numba import njit

from stagectl.robot.midranging import loop_model_kernel as loop
from stagectl.robot.midranging.least_squares_kernel import ORDER

ERRORS, CONTROLS, POSITIONS = 0, ORDER, 2 * ORDER
"""Of `memory`, latest first: past errors (m) and signals (m/s) of the inner controller, positions (m)."""
SHARE, CONTROL, CELLS = 3 * ORDER, 3 * ORDER + 1, 3 * ORDER + 2
NUMERATOR, DENOMINATOR = 0, ORDER + 1
"""Of `settings`: the inner controller (3.6)."""
LIMIT, TRAVEL, HORIZON = range(2 * ORDER + 2, 2 * ORDER + 5)
"""Of `settings`: m/s, m to either side of the middle, samples."""


@njit(cache=True, nogil=True)
def _past(memory, settings):  # type: ignore[no-untyped-def]
    """Return what past errors and signals put into the control signal now, times the first denominator."""
    total = 0.0
    for row in range(ORDER):
        total += settings[NUMERATOR + 1 + row] * memory[ERRORS + row]
        total -= settings[DENOMINATOR + 1 + row] * memory[CONTROLS + row]
    return total


@njit(cache=True, nogil=True)
def _within_travel(memory, settings, model, order, wanted):  # type: ignore[no-untyped-def]
    """Return the reference nearest to `wanted` that, held from now on, keeps the position within the travel.

    The free response f and the step response s of the loop's model: -travel <= f_j + s_j w <= travel for all j.
    """
    travel = settings[TRAVEL]
    low, high = -travel, travel
    f1, f2, f3 = memory[POSITIONS], memory[POSITIONS + 1], memory[POSITIONS + 2]
    w1, w2 = model[loop.INPUTS], model[loop.INPUTS + 1]
    a1, b1 = model[loop.USED], model[loop.USED + order]
    a2 = a3 = b2 = b3 = s1 = s2 = s3 = on2 = on3 = 0.0
    if order > 1:
        a2, b2 = model[loop.USED + 1], model[loop.USED + order + 1]
    if order > 2:
        a3, b3 = model[loop.USED + 2], model[loop.USED + order + 2]
    for _ in range(int(settings[HORIZON])):
        free = a1 * f1 + a2 * f2 + a3 * f3 + b2 * w1 + b3 * w2
        unit = a1 * s1 + a2 * s2 + a3 * s3 + b1 + b2 * on2 + b3 * on3
        f1, f2, f3 = free, f1, f2
        s1, s2, s3 = unit, s1, s2
        w1, w2 = 0.0, w1
        on2, on3 = 1.0, on2
        if unit > 0.0:
            low, high = max(low, (-travel - free) / unit), min(high, (travel - free) / unit)
        elif unit < 0.0:
            low, high = max(low, (travel - free) / unit), min(high, (-travel - free) / unit)
    return min(max(wanted, low), high)


@njit(cache=True, nogil=True)
def govern(memory, settings, model, order, wanted, position):  # type: ignore[no-untyped-def]
    """Return the reference that the fast loop may have now, m, and keep the share of (3.8) and the control signal."""
    loop.push(memory, POSITIONS, position)
    first, past, last = settings[NUMERATOR], _past(memory, settings), model[loop.INPUTS]
    given = _within_travel(memory, settings, model, order, wanted)
    reach = settings[LIMIT] * settings[DENOMINATOR]
    low, high = position + (-reach - past) / first, position + (reach - past) / first
    given = min(max(given, low), high)
    memory[SHARE] = 1.0
    if given != wanted:
        share = (given - last) / (wanted - last) if wanted != last else 0.0
        memory[SHARE] = min(max(share, 0.0), 1.0)
    keep(memory, settings, given, position, past)
    return given


@njit(cache=True, nogil=True)
def keep(memory, settings, given, position, past):  # type: ignore[no-untyped-def]
    """Remember what the inner controller makes of the reference it was given."""
    error = given - position
    memory[CONTROL] = (settings[NUMERATOR] * error + past) / settings[DENOMINATOR]
    loop.push(memory, ERRORS, error)
    loop.push(memory, CONTROLS, memory[CONTROL])
