"""Which clamping pose shows a joint's stiffness least underestimated: the one with the longest lever arm."""

from dataclasses import dataclass

import numpy as np

from calibration.joint_clamping.arm_compliance import joint_compliance
from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import forward, jacobian

LEAST_SINGULAR = 0.02
"""Of the Jacobian over the reach; poses nearer to a singularity are not advised."""


@dataclass(frozen=True)
class Advice:
    """A clamping pose, and what a joint will show in it.

    Parameters
    ----------
    joint : int
        From 0.
    pose : array, shape (joints,), rad
    measured_share : float, 1
        Stiffness that will be measured, over the true one: 1 is a perfect clamp.
    lever_arm : float, m
        Torque of the joint alone over the force that it puts on the clamp.
    """

    joint: int
    pose: np.ndarray
    measured_share: float
    lever_arm: float


def advise(
    arm: Arm,
    joint: int,
    poses: np.ndarray,
    own: np.ndarray,
    tilting: np.ndarray,
    environment: np.ndarray,
) -> list[Advice]:
    """Rank clamping poses for a joint, the best first.

    Parameters
    ----------
    arm : Arm
    joint : int
        From 0.
    poses : array, shape (poses, joints), rad
        Where the arm could be clamped; those near a singularity are left out.
    own, tilting, environment : array, shape (joints,), (joints, 2), (6, 6), SI
        Rough guesses do: only the ranking counts.  See `joint_compliance`.

    Source
    ------
    Sornmo 2015, 4.5: with a long lever arm the stiffness is less underestimated.
    """
    arm.refuse_outside(poses)
    if not 0 <= joint < arm.joints:
        raise ValueError(f"joint is {joint}, must be 0 to {arm.joints - 1}")
    found = []
    for pose in poses:
        matrix = jacobian(arm, pose)
        weights = np.array([1.0, 1.0, 1.0, arm.reach, arm.reach, arm.reach])
        if np.linalg.svd(weights[:, None] * matrix, compute_uv=False)[-1] < LEAST_SINGULAR * arm.reach:
            continue
        share = own[joint] / joint_compliance(arm, pose, own, tilting, environment)[joint, joint]
        force = np.linalg.solve(matrix.T, np.eye(arm.joints)[joint])[:3]
        found.append(Advice(joint, pose, float(share), float(1 / np.linalg.norm(force))))
    return sorted(found, key=lambda each: -each.measured_share)


def candidate_poses(arm: Arm, count: int, seed: int, least_height: float) -> np.ndarray:
    """Draw poses within the limits whose flange is above a height.

    Parameters
    ----------
    arm : Arm
    count : int
    seed : int
    least_height : float, m
        Of the flange over the base: below is the floor.

    Returns
    -------
    array, shape (count or fewer, joints), rad
    """
    low, high = np.maximum(arm.low, -np.pi), np.minimum(arm.high, np.pi)
    poses = np.random.default_rng(seed).uniform(low, high, (4 * count, arm.joints))
    return poses[forward(arm, poses)[:, 2, 3] > least_height][:count]
