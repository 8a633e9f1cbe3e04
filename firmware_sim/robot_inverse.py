"""What the controller makes of its joint angles: the pose of a rigid arm, and the angles for a pose."""

import numpy as np

from firmware_sim.plants.robot import RobotPlant
from firmware_sim.plants.robot_geometry_kernel import jacobians, place
from firmware_sim.plants.robot_run_kernel import write_pose

_DAMPING = 1e-6
_ROUNDS = 4


def rigid_pose(plant: RobotPlant, angle: np.ndarray) -> np.ndarray:
    """Return the tool's pose were the arm rigid, shape (7,), m and unit quaternion, for motor angles (6,), rad."""
    frames, pose = np.zeros((8, 3, 4)), np.zeros(7)
    place(angle, np.zeros((6, 2)), plant.links, plant.tool, frames)
    write_pose(frames[7], pose)
    return pose


def toward(plant: RobotPlant, angle: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Return joint angles, shape (6,), rad, for a tool pose near the one at `angle`, by damped Newton steps.

    The controller knows nothing of what is soft: the angles are those of a rigid arm.

    Parameters
    ----------
    plant : RobotPlant
    angle : array, shape (6,), rad
    pose : array, shape (7,), m and 1
        Position, then the unit quaternion w x y z.
    """
    found, still = angle.copy(), np.zeros((6, 2))
    frames, jacobian, across = np.zeros((8, 3, 4)), np.zeros((6, 6)), np.zeros((6, 12))
    wanted = _rotation(pose[3:])
    for _ in range(_ROUNDS):
        place(found, still, plant.links, plant.tool, frames)
        jacobians(frames, jacobian, across)
        turn = 0.5 * np.cross(frames[7, :, :3], wanted, axisa=0, axisb=0, axisc=0).sum(axis=1)
        gap = np.concatenate([pose[:3] - frames[7, :, 3], turn])
        found += np.linalg.solve(jacobian.T @ jacobian + _DAMPING * np.eye(6), jacobian.T @ gap)
    return found


def _rotation(quaternion: np.ndarray) -> np.ndarray:
    w, x, y, z = quaternion
    spin = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + 2 * w * spin + 2 * spin @ spin)
