"""From recordings to models: each joint's map as it was measured, and with the motion of the arm's side taken off."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from calibration.joint_clamping.compensated import extract_compensated
from calibration.joint_clamping.compensation import arm_motion_of_deflection
from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.joint_model import JointModel
from calibration.joint_clamping.torque_map import TorqueMap
from ctlblocks.recording import Recording
from stagectl.robot.arm import Arm

WAYS = ("as measured", "by the tool's deflection", "by the link's motion")
"""How the motion of the arm's side is known, from worst to best."""


@dataclass(frozen=True)
class JointResult:
    """All that is known of one joint.

    Parameters
    ----------
    joint : int
        From 0.
    map : TorqueMap
    models : dict of JointModel
        By one of `WAYS`; at least the first.
    """

    joint: int
    map: TorqueMap
    models: dict[str, JointModel]

    @property
    def best(self) -> tuple[str, JointModel]:
        """The model that allows for most of the arm's motion, and its way."""
        way = [way for way in WAYS if way in self.models][-1]
        return way, self.models[way]


def of_map(joint: TorqueMap, link: np.ndarray | None, number: int = 0) -> JointResult:
    """Extract the models of one map.

    Parameters
    ----------
    joint : TorqueMap
    link : array or None, shape (samples,), rad
        Measured motion of the arm's side.
    number : int
        The joint, from 0.
    """
    models = {WAYS[0]: extract(joint)}
    if link is not None:
        models[WAYS[2]] = extract_compensated(joint, link)
    return JointResult(number, joint, models)


def of_recording(recorded: Recording, joint: int, arm: Arm, pose: np.ndarray) -> JointResult:
    """Extract the models of one joint's recording.

    Parameters
    ----------
    recorded : Recording
        As `measurement.measure` gives them.
    joint : int
        From 0.
    arm : Arm
        With its tool.
    pose : array, shape (joints,), rad
        The clamping pose.
    """
    data = recorded.data.astype(float)
    columns = {name: data[:, place] for place, name in enumerate(recorded.names)}
    found = TorqueMap(columns[f"angle_{joint + 1}"], columns[f"torque_{joint + 1}"], recorded.rate)
    result = of_map(found, columns.get(f"link_{joint + 1}"), joint)
    if "pose_7" in columns:
        tool = np.stack([columns[f"pose_{place}"] for place in range(1, 8)], axis=1)
        motion = arm_motion_of_deflection(arm, pose, deflection(tool))[:, joint]
        result.models[WAYS[1]] = extract_compensated(found, motion)
    return result


def deflection(pose: np.ndarray) -> np.ndarray:
    """Return how a pose has moved from its mean, small, shape (samples, 6), m and rad.

    Parameters
    ----------
    pose : array, shape (samples, 7), m and 1
        Position and unit quaternion w x y z.
    """
    turned = Rotation.from_quat(pose[:, [4, 5, 6, 3]])
    middle = turned.mean()
    return np.column_stack([pose[:, :3] - pose[:, :3].mean(axis=0), (turned * middle.inv()).as_rotvec()])
