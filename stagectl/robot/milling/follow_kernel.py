"""The compiled kernel that judges whether the robot follows as identified: its model in free run beside it."""

import math

from rigkit.compiled import njit
from rigkit.record import Record
from stagectl.robot.milling.velocity_loop_kernel import foreseen

MEAN, SHARE = 0.25, 0.5
"""Difference of the means, over the larger one, and mean square of the difference about them, over that of the larger
one, beyond which the robot does not follow as identified."""


@njit(cache=True, nogil=True)
def begin(follow: Record) -> None:
    """Be at rest."""
    for i in range(len(follow.state)):
        follow.state[i] = 0.0
    follow.seen = follow.foreseen = 0.0
    follow.seen_power = follow.foreseen_power = follow.error_power = 0.0
    follow.strange = 0


@njit(cache=True, nogil=True)
def _foreseen(follow: Record, loop: Record) -> float:
    """Return what the model makes of all that was asked, m/s, whatever was measured."""
    n = loop.states - 1  # without the disturbance
    velocity = foreseen(loop, n, loop.asked, follow.state, follow.work)
    for i in range(n):
        follow.state[i] = follow.work[i]
    return velocity


@njit(cache=True, nogil=True)
def observe(follow: Record, loop: Record, measured: float) -> bool:
    """Go on by a sample, m/s; return whether the robot has followed otherwise for long enough to be sure of it."""
    foreseen = _foreseen(follow, loop)
    if not math.isfinite(measured):
        return False
    part = follow.forget
    seen = follow.seen + part * (measured - follow.seen)
    model = follow.foreseen + part * (foreseen - follow.foreseen)
    one, other = measured - seen, foreseen - model
    seen_power = follow.seen_power + part * (one * one - follow.seen_power)
    foreseen_power = follow.foreseen_power + part * (other * other - follow.foreseen_power)
    error_power = follow.error_power + part * ((one - other) ** 2 - follow.error_power)
    power, floor = max(seen_power, foreseen_power), follow.floor
    is_strange = abs(seen - model) - floor > MEAN * max(abs(seen), abs(model))
    is_strange = is_strange or (power > floor * floor and error_power > SHARE * power)
    strange = follow.strange + 1 if is_strange else 0
    follow.seen, follow.foreseen, follow.strange = seen, model, strange
    follow.seen_power, follow.foreseen_power, follow.error_power = seen_power, foreseen_power, error_power
    return bool(strange >= follow.patience)
