"""One arm of a kind: what differs from arm to arm, drawn from a seed."""

import numpy as np

from firmware_sim.plants.robot_arms import Arm
from firmware_sim.plants.robot_geometry_kernel import centres, masses, place
from firmware_sim.plants.robot_joint_kernel import (
    ACROSS_X,
    BACKLASH,
    BRISTLE,
    COLD,
    COOLING,
    COULOMB,
    DAMPING,
    DRAG,
    GRAVITY_MODEL,
    HARDENING,
    HEATING,
    INERTIA,
    LOADED,
    POSITION_GAIN,
    RESET_RATE,
    ROWS,
    SPEED_GAIN,
    STICTION,
    STIFF_MINUS,
    STIFF_PLUS,
    STRIBECK,
    TORQUE_LIMIT,
    VISCOUS,
)
from firmware_sim.plants.robot_options import RobotOptions

STIFFNESS_SPREAD, SIDE_SPREAD, FRICTION_SPREAD, MASS_SPREAD, GRAVITY_SPREAD = 0.15, 0.05, 0.25, 0.03, 0.03
"""Relative standard deviations, cut off at two of them."""
MEAN_BACKLASH = 1e-4
"""rad; from 0.3 to 1.7 times that between joints."""
PRESLIDING = 4e-5
"""rad over which a gear yields before it slides."""
JOINT_LOSS = 5e-4
"""s, damping over stiffness of a gear: damping ratio 0.03 at 20 Hz; friction and servo add theirs."""
SERVO_GAIN, SERVO_RESET = 20.0, 15.0
SERVO_SPEED = np.array([200.0, 200.0, 200.0, 300.0, 300.0, 300.0])
"""1/s: position gain, integral over proportional part, bandwidth of the speed loops with half the arm's inertia."""


def draw_joints(rng: np.random.Generator, arm: Arm, options: RobotOptions) -> np.ndarray:
    """Return the kernel's table of joints without the gains of the servo, shape (ROWS, 6), SI units."""

    def drawn(spread: float) -> np.ndarray:
        return np.asarray(1 + options.spread * spread * np.clip(rng.standard_normal(6), -2, 2))

    table = np.zeros((ROWS, 6))
    stiffness = np.array(arm.stiffness) / options.compliance * drawn(STIFFNESS_SPREAD)
    table[STIFF_PLUS], table[STIFF_MINUS] = stiffness, stiffness * drawn(SIDE_SPREAD)
    table[BACKLASH] = options.backlash * MEAN_BACKLASH * (1 + options.spread * rng.uniform(-0.35, 0.35, 6))
    table[TORQUE_LIMIT] = arm.torque_limit
    table[HARDENING] = options.hardening * (stiffness / table[TORQUE_LIMIT]) ** 2 / 3  # slope of the cubic
    table[DAMPING] = JOINT_LOSS * stiffness
    table[INERTIA] = arm.motor_inertia
    table[COULOMB] = options.friction * np.array(arm.coulomb) * drawn(FRICTION_SPREAD)
    table[DRAG] = options.link_friction * table[COULOMB]
    table[COULOMB] -= table[DRAG]
    table[STICTION] = options.stiction * table[COULOMB]
    table[STRIBECK] = options.stribeck
    table[LOADED], table[COLD] = options.load_friction, options.cold
    table[HEATING], table[COOLING] = 1e-3 * options.heating, 1.0 / options.cooling
    table[VISCOUS] = options.friction * np.array(arm.viscous) * drawn(FRICTION_SPREAD)
    table[BRISTLE] = np.array(arm.coulomb) / PRESLIDING
    table[GRAVITY_MODEL] = drawn(GRAVITY_SPREAD)
    for axis in range(2):
        table[ACROSS_X + axis] = options.orthogonal / (np.array(arm.across) * drawn(STIFFNESS_SPREAD))
    return table


def draw_links(rng: np.random.Generator, arm: Arm, options: RobotOptions) -> np.ndarray:
    """Return the kernel's table of links, shape (7, 9), rad, m and kg."""
    links = arm.links
    links[:6, 7] *= 1 + options.spread * MASS_SPREAD * np.clip(rng.standard_normal(6), -2, 2)
    links[6, 6], links[6, 7] = options.tool, options.payload
    return links


def tune_servo(joints: np.ndarray, links: np.ndarray, home: np.ndarray, tool: float) -> None:
    """Fill the servo's gains in `joints` (ROWS, 6) for the inertia at home (6,), rad."""
    frames, centre, mass = np.zeros((8, 3, 4)), np.zeros((7, 3)), np.zeros((6, 6))
    place(home, np.zeros((6, 2)), links, tool, frames)
    centres(frames, np.ascontiguousarray(links), centre)
    masses(frames, centre, links, mass)
    joints[POSITION_GAIN], joints[RESET_RATE] = SERVO_GAIN, SERVO_RESET
    joints[SPEED_GAIN] = SERVO_SPEED * (joints[INERTIA] + 0.5 * np.diag(mass))
