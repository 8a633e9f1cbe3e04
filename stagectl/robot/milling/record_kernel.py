"""From angles and torques of the motors to forces on the tool, a whole record or one sample a call."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from stagectl.robot.milling import force_kernel
from stagectl.robot.milling.torque_kernel import carry, follow_speed, friction_range, levers, place

JOINTS = 6
POLE, RATE, GRAVITY, FADE = range(4)
"""Of `numbers`: of the speeds' low-pass; samples/s; m/s^2; what is left of an acceleration after a sample."""
AT_REST, BY_ACCELERATION = range(2)
"""Rows of `margin` (2, 6): slack of the torques, N m, and N m per rad/s^2."""

# `memory` (3, 6): last angle (rad), speed (rad/s), the largest acceleration lately (rad/s^2).  `frames` (7, 3, 4).
# `work` (ROWS, 6): Jacobian in three rows, gravity and torque without it, slack, friction's bounds, then that of
# `force_kernel`.
ANGLE, SPEED, ACCELERATION = range(3)
MEMORY = 3
LEVERS, WEIGHT, BARE, SLACK, FRICTION, FORCE = 0, 3, 4, 5, 6, 8
ROWS = FORCE + force_kernel.ROWS


@njit(cache=True, nogil=True)
def estimate_record(
    seen: tuple[np.ndarray, ...],
    model: tuple[np.ndarray, ...],
    which: int,
    room: tuple[np.ndarray, ...],
    told: tuple[np.ndarray, ...],
) -> None:
    """Fill force and its bounds (samples, 3), N, whether there is one only and the objective, (samples, 1) each.

    `seen`: angle (rad) and torque (N m), (samples, 6).  `model`: chain, moments, knots, bounds, covariance, margin,
    numbers.  `room`: memory, frames, work.  Where a speed is beyond the knots, or a number is none: NaN between bounds
    without end.
    """
    (angle, torque), (memory, frames, work), (force, low, high, unique, objective) = seen, room, told
    chain, moments, knots, bounds, covariance, margin, numbers = model
    friction, jacobian, slack, speed = work[FRICTION:FORCE], work[LEVERS:WEIGHT], work[SLACK], memory[SPEED]
    for n in range(len(angle)):
        slack[:] = speed
        follow_speed(angle[n], memory[ANGLE], speed, numbers[POLE], numbers[RATE])
        for i in range(JOINTS):
            gained = abs(speed[i] - slack[i]) * numbers[RATE] if np.isfinite(angle[n, i]) else 0.0
            memory[ACCELERATION, i] = flushed(max(gained, numbers[FADE] * memory[ACCELERATION, i]))
            slack[i] = margin[AT_REST, i] + margin[BY_ACCELERATION, i] * memory[ACCELERATION, i]
        place(angle[n], chain, frames)
        levers(frames, jacobian)
        carry(frames, moments, numbers[GRAVITY], work[WEIGHT])
        for i in range(JOINTS):
            work[BARE, i] = torque[n, i] - work[WEIGHT, i]
        if not friction_range(speed, knots, bounds, friction):
            friction[:] = np.nan
        objective[n, 0], one = force_kernel.estimate(
            work[BARE], jacobian, friction, slack, covariance, which, force[n], low[n], high[n], work[FORCE:]
        )
        unique[n, 0] = 1.0 if one else 0.0
