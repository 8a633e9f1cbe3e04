"""One joint of the simulated robot: gear with backlash and nonlinear spring, friction, servo."""

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit

# Rows of `joints` (ROWS, 6), seen from the arm's side of the gear; of `state` (CELLS, 6); SI units.  LOADED is friction
# over the torque in the gear, COLD by what viscous friction is larger at no WARMTH, HEATING and COOLING what a watt and
# a second make of that.  DRAG is Coulomb's friction of the link, beyond the gear; DRAGGED how far its bristles give.
(
    STIFF_PLUS, STIFF_MINUS, BACKLASH, HARDENING, DAMPING, INERTIA, COULOMB, STICTION, STRIBECK, VISCOUS, BRISTLE,
    POSITION_GAIN, SPEED_GAIN, RESET_RATE, TORQUE_LIMIT, GRAVITY_MODEL, ACROSS_X, ACROSS_Y, LOADED, COLD, HEATING,
    COOLING, DRAG, ROWS,
) = range(24)  # fmt: skip
MOTOR, MOTOR_SPEED, LINK, LINK_SPEED, PRESLIDE, INTEGRAL, WANTED, SOFT, OVERLOAD, WARMTH, DRAGGED, CELLS = range(12)
SOFTENING_TIME = 0.5
"""s in which the servo turns soft, or stiff again."""


@njit(cache=True, nogil=True)
def spring(i: int, wind_up: float, joints: np.ndarray) -> tuple[float, float]:
    """Return torque (N m) and tangent stiffness (N m/rad) of a joint's gear wound up by `wind_up` (rad).

    No torque within the backlash; beyond it stiffness + or -, growing with the square of what is beyond.
    """
    half = 0.5 * joints[BACKLASH, i]
    beyond = wind_up - half if wind_up > half else (wind_up + half if wind_up < -half else 0.0)
    if beyond == 0.0:
        return 0.0, 0.0
    stiffness = joints[STIFF_PLUS, i] if beyond > 0.0 else joints[STIFF_MINUS, i]
    harder = joints[HARDENING, i] * beyond * beyond
    return stiffness * beyond * (1.0 + harder), stiffness * (1.0 + 3.0 * harder)


@njit(cache=True, nogil=True)
def _given(given: float, speed: float, step: float, bristle: float, level: float) -> tuple[float, float]:
    """Return how far bristles give after a step, rad, and the slope of their torque over speed, N m s/rad; implicit.

    They slide where their torque, `bristle` (N m/rad) times what they give, comes near `level` (N m).
    """
    slip = 1.0 + step * bristle * abs(speed) / level
    return (given + step * speed) / slip, bristle * step / slip


@njit(cache=True, nogil=True)
def friction(i: int, step: float, load: float, joints: np.ndarray, state: np.ndarray) -> tuple[float, float]:
    """Move a joint's bristles on by a step (s); return torque (N m) and its slope over speed (N m s/rad).

    Coulomb with Stribeck effect, viscous, and elastic before it slides, so that torque over angle is a loop.  Without
    damping of the bristles it takes energy at any speed.  [Canudas de Wit et al., IEEE TAC 40 (1995) 419, (1)-(4)]
    Coulomb's part grows with the gear's `load` (N m), the viscous one falls as friction warms the joint: [Bittencourt
    and Axelsson, IEEE/ASME Trans. Mechatron. 19 (2014) 1467, for both forms]
    """
    speed, bristle, viscous = state[MOTOR_SPEED, i], joints[BRISTLE, i], joints[VISCOUS, i]
    if joints[COLD, i] != 0.0:
        viscous *= 1.0 + joints[COLD, i] * np.exp(-state[WARMTH, i])
    if joints[COULOMB, i] == 0.0:
        return viscous * speed, viscous
    drop = np.exp(-((speed / joints[STRIBECK, i]) ** 2))
    heavy = 1.0 + joints[LOADED, i] * abs(load) / joints[COULOMB, i]
    level = (joints[COULOMB, i] + (joints[STICTION, i] - joints[COULOMB, i]) * drop) * heavy
    state[PRESLIDE, i], slope = _given(state[PRESLIDE, i], speed, step, bristle, level)
    torque = bristle * state[PRESLIDE, i] + viscous * speed
    warmed = joints[HEATING, i] * abs(torque * speed) - joints[COOLING, i] * state[WARMTH, i]
    state[WARMTH, i] = flushed(state[WARMTH, i] + step * warmed)
    return torque, viscous + slope


@njit(cache=True, nogil=True)
def drag(i: int, step: float, joints: np.ndarray, state: np.ndarray) -> tuple[float, float]:
    """Move the bristles of a link's own bearing and seals on by a step (s); return torque (N m) and its slope.

    As `friction`, by Coulomb's part alone: it holds a link that is within the backlash of its gear.
    """
    speed, bristle = state[LINK_SPEED, i], joints[BRISTLE, i]
    given, slope = _given(state[DRAGGED, i], speed, step, bristle, joints[DRAG, i])
    state[DRAGGED, i] = flushed(given)
    return bristle * state[DRAGGED, i], slope


@njit(cache=True, nogil=True)
def servo(
    i: int, step: float, wanted: float, gravity: float, soft: np.ndarray, joints: np.ndarray, state: np.ndarray
) -> float:
    """Return the torque (N m) that a drive gives: P on angle within PI on speed, and its model of gravity.

    `soft` (2, 6) has by how much the P gain is smaller in soft servo, and whether soft servo is on; then the integral
    fades and stays off.
    """
    rate = step / SOFTENING_TIME
    state[SOFT, i] += min(max(soft[1, i] - state[SOFT, i], -rate), rate)
    ramp = state[SOFT, i]
    rising = (wanted - state[WANTED, i]) / step
    state[WANTED, i] = wanted
    gain = joints[POSITION_GAIN, i] * (1.0 - soft[0, i] * ramp)
    error = gain * (wanted - state[MOTOR, i]) + rising - state[MOTOR_SPEED, i]
    torque = joints[SPEED_GAIN, i] * error + (1.0 - ramp) * state[INTEGRAL, i] - joints[GRAVITY_MODEL, i] * gravity
    limit = joints[TORQUE_LIMIT, i]
    if ramp == 1.0:
        state[INTEGRAL, i] = 0.0
    elif abs(torque) <= limit and soft[1, i] == 0.0:
        state[INTEGRAL, i] += joints[RESET_RATE, i] * step * joints[SPEED_GAIN, i] * error
    return float(min(max(torque, -limit), limit))
