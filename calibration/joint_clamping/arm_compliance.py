"""The compliance that a clamped arm's joints feel: their own, their bearings' tilting, and the environment's."""

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import frames, jacobian, turns


def tilts(arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
    """Return how the flange moves when the joints' bearings tilt.

    Joint i tilts about the x and the y of the link before it, whose z is the joint's axis.

    Parameters
    ----------
    arm : Arm
    joint_angle : array, shape (joints,), rad

    Returns
    -------
    array, shape (6, joints, 2), m/rad and 1
    """
    link = frames(arm, joint_angle)
    before, flange = link[:-1], link[-1, :3, 3]
    columns = [turns(before[:, :3, axis], before[:, :3, 3], flange) for axis in (0, 1)]
    return np.stack(columns, axis=-1).swapaxes(0, 1)


def joint_compliance(
    arm: Arm, joint_angle: np.ndarray, own: np.ndarray, tilting: np.ndarray, environment: np.ndarray
) -> np.ndarray:
    """Return the compliance of all joints in the clamp: motor angles per torques.

    Parameters
    ----------
    arm : Arm
    joint_angle : array, shape (joints,), rad
        The clamping pose.
    own : array, shape (joints,), rad/(N m)
        1 / stiffness of each joint about its axis.
    tilting : array, shape (joints, 2), rad/(N m)
        Orthogonal compliance, about the axes of `tilts`.
    environment : array, shape (6, 6), m/N, rad/N, m/(N m), rad/(N m)
        Of the clamp, in the axes of the base.

    Returns
    -------
    array, shape (joints, joints), rad/(N m)

    Source
    ------
    Closing the chain: J q - sum of tilts = C_e F with J^T F = torque; each tilt is -c t^T F along its column t.
    """
    inverse = np.linalg.inv(jacobian(arm, joint_angle))
    columns = tilts(arm, joint_angle).reshape(6, -1)
    total = environment + (columns * tilting.ravel()) @ columns.T
    found: np.ndarray = np.diag(own) + inverse @ total @ inverse.T
    return found
