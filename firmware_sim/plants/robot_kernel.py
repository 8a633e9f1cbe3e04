"""The simulated robot step by step: drives, gears, links and what holds the tool, by a linearly implicit rule."""

from typing import NamedTuple

import numpy as np

from firmware_sim.plants.robot_geometry_kernel import centres, jacobians, masses, place, weights, whirls
from firmware_sim.plants.robot_joint_kernel import (
    ACROSS_X,
    DAMPING,
    DRAG,
    INERTIA,
    LINK,
    LINK_SPEED,
    MOTOR,
    MOTOR_SPEED,
    OVERLOAD,
    TORQUE_LIMIT,
    drag,
    friction,
    servo,
    spring,
)
from rigkit.compiled import njit

IMPLICIT = 0.55
"""Part of a step's end in its rule: 0.5 keeps energy, 1 damps; here so little damping that 20 Hz loses 0.08 %."""
CLAMP_LOSS = 2e-4
"""s, damping over stiffness of what holds the tool."""
OVERLOAD_LEVEL, OVERLOAD_TIME = 0.95, 0.05
"""Part of the torque limit, and s beyond it, after which torque supervision puts the brakes on."""
BRAKE, TRIPPED, CLAMPED, SLIP_FORCE, STEP, REFRESH, PHASE, SLIPPED = range(8)
"""What is in `switches` (8,): flags, N, s, steps, steps since the last refresh, m slipped."""


class Parts(NamedTuple):
    """All arrays of an arm; `links`, `joints` and `state` as the kernels say.

    `frozen` (6, 23) has what is renewed each millisecond: mass, Jacobian, the clamp's stiffness in the joints (6
    columns each), load, gravity, angle, the clamp's torque, what turning links load.  `anchor` (5, 6): how far the
    clamp has slipped, its wrench, and in the last three rows the frame it holds.  `work` (6, 10) is room for the
    solution.
    """

    links: np.ndarray
    joints: np.ndarray
    state: np.ndarray
    soft: np.ndarray
    switches: np.ndarray
    frames: np.ndarray
    centre: np.ndarray
    jacobian: np.ndarray
    across: np.ndarray
    moment: np.ndarray
    frozen: np.ndarray
    anchor: np.ndarray
    environment: np.ndarray
    tilt: np.ndarray
    wrench: np.ndarray
    work: np.ndarray


MASS, JACOBIAN, HOLD, LOAD, WEIGHT, ANGLE, HELD, WHIRL = 0, 6, 12, 18, 19, 20, 21, 22
"""Columns of `frozen`."""


@njit(cache=True, nogil=True)
def refresh(external: np.ndarray, tool: float, parts: Parts) -> None:
    """Renew what changes with configuration: geometry, masses, loads, and how the clamp is felt in the joints."""
    frozen, state = parts.frozen, parts.state
    zero = np.zeros((6, 2))
    place(state[LINK], zero, parts.links, tool, parts.frames)
    centres(parts.frames, parts.links, parts.centre)
    jacobians(parts.frames, parts.jacobian, parts.across)
    masses(parts.frames, parts.centre, parts.links, frozen[:, MASS : MASS + 6])
    weights(parts.frames, parts.centre, parts.links, parts.moment)
    whirls(parts.frames, parts.centre, parts.links, state[LINK_SPEED], frozen[:, WHIRL])
    frozen[:, JACOBIAN : JACOBIAN + 6] = parts.jacobian
    frozen[:, ANGLE], frozen[:, WEIGHT] = state[LINK], parts.moment[:, 2]
    frozen[:, HOLD : HOLD + 6], frozen[:, HELD] = 0.0, 0.0
    if parts.switches[CLAMPED] != 0.0:
        _hold(external, parts)
    bear(external, parts)


@njit(cache=True, nogil=True)
def bear(external: np.ndarray, parts: Parts) -> None:
    """Renew what the wrench on the tool loads and tilts, in a geometry that stays."""
    frozen, joints = parts.frozen, parts.joints
    parts.wrench[:] = external
    if parts.switches[CLAMPED] != 0.0:
        parts.wrench[:] += parts.anchor[1]
    for i in range(6):
        for column in range(2):
            load = parts.moment[i, column]
            for r in range(6):
                load += parts.across[r, 2 * i + column] * parts.wrench[r]
            parts.tilt[i, column] = joints[ACROSS_X + column, i] * load
    for i in range(6):
        frozen[i, LOAD] = frozen[i, WHIRL]
        for r in range(6):
            frozen[i, LOAD] -= parts.jacobian[r, i] * external[r]
        frozen[i, LOAD] -= frozen[i, WEIGHT]


@njit(cache=True, nogil=True)
def _hold(external: np.ndarray, parts: Parts) -> None:
    """Find the clamp's wrench (`anchor[1]`, N and N m) and its stiffness in the joints; let it slip beyond its limit.

    What is soft across the axes lies in series with the environment: it has no mass of its own.
    """
    frozen, across, switches = parts.frozen, parts.across, parts.switches
    total = parts.environment.copy()
    gap = _gap(parts)
    for i in range(6):
        for column in range(2):
            at, soft = 2 * i + column, parts.joints[ACROSS_X + column, i]
            load = parts.moment[i, column]
            for r in range(6):
                load += across[r, at] * external[r]
            for r in range(6):
                gap[r] -= across[r, at] * soft * load
                for c in range(6):
                    total[r, c] += across[r, at] * soft * across[c, at]
    wrench = parts.anchor[1]
    stiffness = _inverse(total)
    for r in range(6):
        wrench[r] = 0.0
        for c in range(6):
            wrench[r] += stiffness[r, c] * gap[c]
    force = np.sqrt(wrench[0] ** 2 + wrench[1] ** 2 + wrench[2] ** 2)
    if force > switches[SLIP_FORCE]:
        kept = switches[SLIP_FORCE] / force
        for r in range(6):
            parts.anchor[0, r] -= (1.0 - kept) * gap[r]
            wrench[r] *= kept
        switches[SLIPPED] += (1.0 - kept) * np.sqrt(gap[0] ** 2 + gap[1] ** 2 + gap[2] ** 2)
    for i in range(6):
        for r in range(6):
            frozen[i, HELD] += parts.jacobian[r, i] * wrench[r]
            felt = 0.0
            for c in range(6):
                felt += stiffness[r, c] * parts.jacobian[c, i]
            for j in range(6):
                frozen[j, HOLD + i] += parts.jacobian[r, j] * felt


@njit(cache=True, nogil=True)
def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse of a symmetric, positive definite (6, 6), in its place, by sweeping pivot after pivot."""
    for k in range(6):
        pivot = matrix[k, k]
        for i in range(6):
            if i != k:
                share = matrix[i, k] / pivot
                for j in range(6):
                    if j != k:
                        matrix[i, j] -= share * matrix[k, j]
        for i in range(6):
            if i != k:
                matrix[i, k] /= -pivot
                matrix[k, i] /= pivot
        matrix[k, k] = 1.0 / pivot
    return matrix


@njit(cache=True, nogil=True)
def _gap(parts: Parts) -> np.ndarray:
    """Return from the tool, were nothing soft across the axes, to the clamp: m and rad, (6,)."""
    gap = np.empty(6)
    tool, clamp = parts.frames[7], parts.anchor[2:5]
    for r in range(3):
        gap[r] = parts.anchor[0, r] + clamp[r, 3] - tool[r, 3]
        gap[3 + r] = parts.anchor[0, 3 + r]
    for column in range(3):  # half the sum of the columns' cross products: a small rotation's vector
        ax, ay, az = tool[0, column], tool[1, column], tool[2, column]
        bx, by, bz = clamp[0, column], clamp[1, column], clamp[2, column]
        gap[3] += 0.5 * (ay * bz - az * by)
        gap[4] += 0.5 * (az * bx - ax * bz)
        gap[5] += 0.5 * (ax * by - ay * bx)
    return gap


@njit(cache=True, nogil=True)
def advance(wanted: np.ndarray, torque: np.ndarray, parts: Parts) -> None:
    """Go on by one step with angles `wanted` (rad); fill the drives' torque (N m)."""
    frozen, joints, state, work, switches = parts.frozen, parts.joints, parts.state, parts.work, parts.switches
    step = switches[STEP]
    near, rule = step * IMPLICIT, step * step * IMPLICIT
    locked = switches[BRAKE] != 0.0 or switches[TRIPPED] != 0.0
    for i in range(6):
        torque[i] = 0.0 if locked else servo(i, step, wanted[i], frozen[i, WEIGHT], parts.soft, joints, state)
        _supervise(i, torque[i], parts)
        wound, stiffness = spring(i, state[MOTOR, i] - state[LINK, i], joints)
        turning, loss = state[MOTOR_SPEED, i] - state[LINK_SPEED, i], joints[DAMPING, i]
        wound += loss * turning
        rubbed, slope = friction(i, step, wound, joints, state)
        own = near * loss + rule * IMPLICIT * stiffness
        to_link = step * wound + rule * stiffness * turning
        heavy = 1e18 if locked else joints[INERTIA, i] + own + near * slope
        to_motor = 0.0 if locked else step * (torque[i] - rubbed) - to_link
        work[i, 6], work[i, 7], work[i, 8] = heavy, own, to_motor
        work[i, 9] = to_link - step * frozen[i, LOAD] + own / heavy * to_motor
        for j in range(6):
            hold = frozen[i, HOLD + j]
            moved = state[LINK, j] - frozen[j, ANGLE] + (near + CLAMP_LOSS) * state[LINK_SPEED, j]
            work[i, 9] -= step * hold * moved
            work[i, j] = frozen[i, MASS + j] + (near * CLAMP_LOSS + rule * IMPLICIT) * hold
        work[i, 9] += step * frozen[i, HELD]
        work[i, i] += own - own * own / heavy
        if joints[DRAG, i] != 0.0:
            held, slope = drag(i, step, joints, state)
            work[i, 9] -= step * held
            work[i, i] += near * slope
    _solve(work)
    for i in range(6):
        gained = work[i, 9]
        motor = (work[i, 8] + work[i, 7] * gained) / work[i, 6]
        state[LINK, i] += step * (state[LINK_SPEED, i] + IMPLICIT * gained)
        state[MOTOR, i] += step * (state[MOTOR_SPEED, i] + IMPLICIT * motor)
        state[LINK_SPEED, i] += gained
        state[MOTOR_SPEED, i] += motor
        if locked:
            state[MOTOR_SPEED, i] = 0.0


@njit(cache=True, nogil=True)
def _supervise(i: int, torque: float, parts: Parts) -> None:
    """Put the brakes on once a drive has been near its limit for too long; note which, counted from 1."""
    if abs(torque) > OVERLOAD_LEVEL * parts.joints[TORQUE_LIMIT, i]:
        parts.state[OVERLOAD, i] += parts.switches[STEP]
        if parts.state[OVERLOAD, i] > OVERLOAD_TIME and parts.switches[TRIPPED] == 0.0:
            parts.switches[TRIPPED] = i + 1.0
    else:
        parts.state[OVERLOAD, i] = 0.0


@njit(cache=True, nogil=True)
def _solve(work: np.ndarray) -> None:
    """Solve the symmetric system in the first six columns for the tenth, in place, by Cholesky's factors."""
    for i in range(6):
        for j in range(i + 1):
            rest = work[i, j]
            for k in range(j):
                rest -= work[i, k] * work[j, k]
            work[i, j] = np.sqrt(rest) if i == j else rest / work[j, j]
    for i in range(6):
        for k in range(i):
            work[i, 9] -= work[i, k] * work[k, 9]
        work[i, 9] /= work[i, i]
    for i in range(5, -1, -1):
        for k in range(i + 1, 6):
            work[i, 9] -= work[k, i] * work[k, 9]
        work[i, 9] /= work[i, i]
