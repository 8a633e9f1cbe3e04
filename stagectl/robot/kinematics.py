"""Kinematics of a serial arm: frames and the geometric Jacobian.

Every function takes one set of joint angles or a stack of them, shape (..., joints), in one call.  Positions and
rotations are in the axes of the base; six-vectors have three translations (m) first and three rotations (rad) after.
"""

import numpy as np

from stagectl.robot.arm import Arm

NEAR_SINGULAR = 0.02
"""Singular values of the Jacobian, rotations weighed by the reach, over the reach: below this they are damped."""


def frames(arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
    """Return the frames of base and links, X_BaseLink.

    Parameters
    ----------
    arm : Arm
    joint_angle : array, shape (..., joints), rad

    Returns
    -------
    array, shape (..., joints + 1, 4, 4), rotations 1, positions m
        The last is that of the flange.
    """
    angle = np.asarray(joint_angle, float)
    if angle.ndim == 0 or angle.shape[-1] != arm.joints:
        raise ValueError(f"joint angles have shape {angle.shape}, must be (..., {arm.joints}) for {arm.name}")
    steps = _steps(arm, angle)
    found = np.empty((*angle.shape[:-1], arm.joints + 1, 4, 4))
    found[..., 0, :, :] = np.eye(4)
    for joint in range(arm.joints):
        np.matmul(found[..., joint, :, :], steps[..., joint, :, :], out=found[..., joint + 1, :, :])
    return found


def forward(arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
    """Return the pose of the flange X_BaseFlange, shape (..., 4, 4), for joint angles, shape (..., joints), rad."""
    return frames(arm, joint_angle)[..., -1, :, :]


def jacobian(arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
    """Return the geometric Jacobian: velocity of the flange's origin and angular velocity, per joint velocity.

    Parameters
    ----------
    arm : Arm
    joint_angle : array, shape (..., joints), rad

    Returns
    -------
    array, shape (..., 6, joints), m/rad and 1
    """
    link = frames(arm, joint_angle)
    axis = link[..., :-1, :3, 2]
    lever = link[..., -1:, :3, 3] - link[..., :-1, :3, 3]
    found = np.empty((*axis.shape[:-2], 6, arm.joints))
    x, y, z = (axis[..., part] for part in range(3))
    along_x, along_y, along_z = (lever[..., part] for part in range(3))
    found[..., 0, :] = y * along_z - z * along_y
    found[..., 1, :] = z * along_x - x * along_z
    found[..., 2, :] = x * along_y - y * along_x
    found[..., 3:, :] = axis.swapaxes(-1, -2)
    return found


def turns(axis: np.ndarray, at: np.ndarray, flange: np.ndarray) -> np.ndarray:
    """Return how the flange moves when what carries it turns about an axis somewhere: a Jacobian's column.

    Parameters
    ----------
    axis : array, shape (..., 3), 1
        Unit vectors.
    at, flange : array, shape (..., 3), m
        A point on the axis, and the flange.

    Returns
    -------
    array, shape (..., 6), m/rad and 1
    """
    return np.concatenate([np.cross(axis, flange - at), axis], axis=-1)


def _steps(arm: Arm, angle: np.ndarray) -> np.ndarray:
    """Return each joint's transform from the link before it, shape (..., joints, 4, 4)."""
    turned = angle + arm.offset
    cos, sin = np.cos(turned), np.sin(turned)
    cos_twist, sin_twist = np.cos(arm.alpha), np.sin(arm.alpha)
    found = np.zeros((*angle.shape, 4, 4))
    found[..., 0, 0], found[..., 0, 1], found[..., 0, 2] = cos, -sin * cos_twist, sin * sin_twist
    found[..., 1, 0], found[..., 1, 1], found[..., 1, 2] = sin, cos * cos_twist, -cos * sin_twist
    found[..., 0, 3], found[..., 1, 3] = arm.a * cos, arm.a * sin
    found[..., 2, 1], found[..., 2, 2], found[..., 2, 3] = sin_twist, cos_twist, arm.d
    found[..., 3, 3] = 1.0
    return found
