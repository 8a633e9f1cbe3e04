"""The compiled governor of one axis: the inner control signal and the travel, kept within their limits."""

from rigkit.compiled import njit
from rigkit.record import Record
from stagectl.robot.midranging.axis_record import ORDER
from stagectl.robot.midranging.loop_model_kernel import push


@njit(cache=True, nogil=True)
def _past(governor: Record) -> float:
    """Return what past errors and signals put into the control signal now, times the first denominator."""
    total = 0.0
    for row in range(ORDER):
        total += governor.numerator[1 + row] * governor.errors[row]
        total -= governor.denominator[1 + row] * governor.controls[row]
    return total


@njit(cache=True, nogil=True)
def _within_travel(governor: Record, model: Record, order: int, wanted: float) -> float:
    """Return the reference nearest to `wanted` that, held from now on, keeps the position within the travel.

    The free response f and the step response s of the loop's model: -travel <= f_j + s_j w <= travel for all j.
    """
    travel = governor.travel
    low, high = -travel, travel
    f1, f2, f3 = governor.positions[0], governor.positions[1], governor.positions[2]
    w1, w2 = model.inputs[0], model.inputs[1]
    a1, b1 = model.used[0], model.used[order]
    a2 = a3 = b2 = b3 = s1 = s2 = s3 = on2 = on3 = 0.0
    if order > 1:
        a2, b2 = model.used[1], model.used[order + 1]
    if order > 2:
        a3, b3 = model.used[2], model.used[order + 2]
    for _ in range(governor.horizon):
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
    return float(min(max(wanted, low), high))


@njit(cache=True, nogil=True)
def position(governor: Record, measured: float, modelled: float) -> float:
    """Return the position that the control signal is made of, m: the model's and its offset, near what is measured."""
    smooth = modelled + governor.offset
    return float(min(max(smooth, measured - governor.lean), measured + governor.lean))


@njit(cache=True, nogil=True)
def govern(governor: Record, model: Record, order: int, wanted: float, position: float, undelayed: float) -> float:
    """Return the reference that the fast loop may have now, m, and keep the share of (3.8) and the control signal.

    `undelayed`: where the loop would be without its dead time, m; the control signal is made of `position`.
    """
    push(governor.positions, undelayed)
    first, past, last = governor.numerator[0], _past(governor), model.inputs[0]
    given = _within_travel(governor, model, order, wanted)
    reach = governor.trust * max(0.0, governor.limit * governor.denominator[0] - abs(first) * governor.margin)
    low, high = position + (-reach - past) / first, position + (reach - past) / first
    given = min(max(given, low), high)
    governor.share = 1.0
    if given != wanted:
        share = (given - last) / (wanted - last) if wanted != last else 0.0
        governor.share = min(max(share, 0.0), 1.0)
    keep(governor, given, position, past)
    return float(given)


@njit(cache=True, nogil=True)
def keep(governor: Record, given: float, position: float, past: float) -> None:
    """Remember what the inner controller makes of the reference it was given."""
    error = given - position
    control = float((governor.numerator[0] * error + past) / governor.denominator[0])
    governor.control = control
    push(governor.errors, error)
    push(governor.controls, control)
