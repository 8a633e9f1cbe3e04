"""Motors and joints: what motors do, taken to the joints' side of gears that couple them."""

from collections.abc import Sequence

import numpy as np

LEAST = 0.05
"""Smallest singular value of a coupling: below it two motors turn joints alike."""


def joint_side(motor_angle: np.ndarray, motor_torque: np.ndarray, gear: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bring motor quantities to the joints' side of the gears.

    Parameters
    ----------
    motor_angle : array, shape (..., joints), rad
    motor_torque : array, shape (..., joints), N m
    gear : array, shape (joints, joints), 1
        J_m: motor angles = J_m x joint angles; off its diagonal stands the coupling of a wrist.

    Returns
    -------
    angle, torque : array, shape (..., joints), rad and N m
        J_m^-1 x angles and J_m' x torques: the power is the same on both sides.

    Source
    ------
    Sörnmo 2015, sec. 4.3: the gear ratio matrix J_m.
    """
    return np.asarray(motor_angle @ np.linalg.inv(gear).T), np.asarray(motor_torque @ gear)


def refuse_coupling(coupling: Sequence[Sequence[float]]) -> None:
    """Refuse, by ValueError, what is neither empty nor a J_m of six joints that can be told apart."""
    if not coupling:
        return
    if len(coupling) != 6:
        raise ValueError(f"robot.coupling has {len(coupling)} rows, must have 6, or none")
    gear = np.array(coupling)
    least = np.linalg.svd(gear, compute_uv=False)[-1] if np.isfinite(gear).all() else np.nan
    if not least >= LEAST:
        raise ValueError(f"robot.coupling has the smallest singular value {least:.3g}, must be >= {LEAST:g} and finite")
