"""Gravity's torques by regression: linear in the links' masses and first moments, which a record of torques tells."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import frames
from stagectl.robot.milling import torque_kernel as kernel

STANDARD_GRAVITY = 9.80665
"""m/s^2; only its product with the moments is measured."""
TELLS_APART = 1e-6
"""Singular values of the regressor below this, over the largest, tell nothing."""


@dataclass(frozen=True, eq=False)
class Gravity:
    """What the links weigh, as far as their torques tell; the base stands level.

    Parameters
    ----------
    moments : array, shape (joints, 4), kg m and kg
        Of each link: mass times centre of mass in the link's own frame, and mass.  Only combinations that torques
        depend on are measured; among all moments with the same torques these are the smallest.
    """

    moments: np.ndarray

    def torque(self, arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
        """Return the torques that hold the arm up, shape (..., joints), N m.

        Parameters
        ----------
        arm : Arm
            As at identification, with its tool.
        joint_angle : array, shape (..., joints), rad
        """
        found: np.ndarray = gravity_regressor(arm, joint_angle) @ self.moments.ravel()
        return found


def gravity_regressor(arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
    """Return what each moment adds to the torques that hold the arm up.

    From the potential energy g sum_k (m_k p_k + R_k m_k c_k)_z, differentiated by each joint angle.

    Parameters
    ----------
    arm : Arm
    joint_angle : array, shape (..., joints), rad

    Returns
    -------
    array, shape (..., joints, 4 joints), N m per kg m and kg
        Columns as in `Gravity.moments`, link by link.

    Source
    ------
    W. Khalil, E. Dombre, Modeling, Identification and Control of Robots, 2002, ch. 12: torques are linear in the
    links' inertial parameters, of which only some combinations can be told.
    """
    link = frames(arm, joint_angle)
    found = np.zeros((*link.shape[:-3], arm.joints, arm.joints, 4))
    for joint in range(arm.joints):
        x, y = link[..., joint, 0, 2], link[..., joint, 1, 2]
        for carried in range(joint, arm.joints):
            own = link[..., carried + 1, :3, :]
            found[..., joint, carried, :3] = x[..., None] * own[..., 1, :3] - y[..., None] * own[..., 0, :3]
            away = own[..., 3] - link[..., joint, :3, 3]
            found[..., joint, carried, 3] = x * away[..., 1] - y * away[..., 0]
    return STANDARD_GRAVITY * found.reshape(*link.shape[:-3], arm.joints, 4 * arm.joints)


def packed_chain(arm: Arm) -> np.ndarray:
    """Return an arm's geometry as the kernel reads it, shape (6, 5); ValueError unless it has six joints."""
    if arm.joints != kernel.JOINTS:
        raise ValueError(f"{arm.name} has {arm.joints} joints, must have {kernel.JOINTS}")
    return np.stack([arm.offset, arm.d, arm.a, np.cos(arm.alpha), np.sin(arm.alpha)], axis=1)


def smallest_moments(regressor: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the smallest moments that explain torques best, and how many combinations of them are told.

    Parameters
    ----------
    regressor : array, shape (equations, moments), any unit
    torque : array, shape (equations,), that of the regressor times kg m or kg

    Returns
    -------
    array, shape (moments,), kg m and kg; int
    """
    size = np.linalg.norm(regressor, axis=0)
    told = size > TELLS_APART * size.max()
    left, value, right = np.linalg.svd(regressor[:, told], full_matrices=False)
    kept = value > TELLS_APART * value[0]
    moments = np.zeros(len(size))
    moments[told] = (right[kept].T / value[kept]) @ (left[:, kept].T @ torque)
    return moments, int(kept.sum())
