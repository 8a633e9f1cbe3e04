"""From angles and torques of the motors to forces on the tool, a whole record or one sample a call."""

import numpy as np
from numba import njit

from stagectl.robot.milling import force_kernel
from stagectl.robot.milling.torque_kernel import carry, follow_speed, friction_range, levers, place

JOINTS = 6
POLE, RATE, GRAVITY = range(3)
"""Of `numbers`: of the speeds' low-pass; samples/s; m/s^2."""

# `memory` (2, 6): last angle (rad), speed (rad/s).  `frames` (7, 3, 4).  `work` (ROWS, 6): Jacobian in three rows,
# gravity and torque without it, friction's bounds, then that of `force_kernel`.
LEVERS, WEIGHT, BARE, FRICTION, FORCE = 0, 3, 4, 5, 7
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

    `seen`: angle (rad) and torque (N m), (samples, 6).  `model`: chain, moments, knots, bounds, covariance, numbers.
    `room`: memory, frames, work.  Where a speed is beyond the knots, or a number is none: NaN between infinite bounds.
    """
    (angle, torque), (memory, frames, work), (force, low, high, unique, objective) = seen, room, told
    chain, moments, knots, bounds, covariance, numbers = model
    friction, jacobian = work[FRICTION:FORCE], work[LEVERS:WEIGHT]
    for n in range(len(angle)):
        follow_speed(angle[n], memory[0], memory[1], numbers[POLE], numbers[RATE])
        place(angle[n], chain, frames)
        levers(frames, jacobian)
        carry(frames, moments, numbers[GRAVITY], work[WEIGHT])
        for i in range(JOINTS):
            work[BARE, i] = torque[n, i] - work[WEIGHT, i]
        if not friction_range(memory[1], knots, bounds, friction):
            friction[:] = np.nan
        objective[n, 0], one = force_kernel.estimate(
            work[BARE], jacobian, friction, covariance, which, force[n], low[n], high[n], work[FORCE:]
        )
        unique[n, 0] = 1.0 if one else 0.0
