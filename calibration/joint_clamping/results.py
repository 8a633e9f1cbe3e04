"""From recordings to models: each joint's map as it was measured, and with the motion of the arm's side taken off."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from calibration.joint_clamping.compensated import extract_compensated
from calibration.joint_clamping.compensation import arm_motion_of_deflection, arm_motion_of_torque
from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.joint_model import JointModel
from calibration.joint_clamping.torque_map import TorqueMap
from calibration.joint_clamping.tracked_links import link_motion, tool_pose, tracked_axis
from ctlblocks.recording import Recording
from stagectl.robot.arm import Arm

RAW, CLAMP, TOOL, LINK = "as measured", "by the clamp's compliance", "by the tool's deflection", "by the link's motion"
WAYS = (RAW, CLAMP, TOOL, LINK)
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
    chosen : str
        The one of `WAYS` that a person wants; nothing for the one that allows for most of the arm's motion.
    pose : int
        Number of the clamping pose, from 1; 0 where there was one only.
    """

    joint: int
    map: TorqueMap
    models: dict[str, JointModel]
    chosen: str = ""
    pose: int = 0

    @property
    def best(self) -> tuple[str, JointModel]:
        """The model that was chosen, or else allows for most of the arm's motion, and its way."""
        way = self.chosen or [way for way in WAYS if way in self.models][-1]
        if way not in self.models:
            raise ValueError(f"joint {self.joint + 1} has no model {way!r}, there are {', '.join(self.models)}")
        return way, self.models[way]


@dataclass(frozen=True)
class Clamped:
    """An arm in its clamp.

    Parameters
    ----------
    arm : Arm
        With its tool.
    pose : array, shape (joints,), rad
        The clamping pose.
    environment : array, shape (6, 6), m/N and rad/(N m)
        The clamp's compliance; zeros where it is not known.
    number : int
        Of the pose, from 1; 0 where there is one only.
    """

    arm: Arm
    pose: np.ndarray
    environment: np.ndarray
    number: int = 0


def of_map(joint: TorqueMap, motions: Mapping[str, np.ndarray], number: int = 0, chosen: str = "") -> JointResult:
    """Extract the models of one map.

    Parameters
    ----------
    joint : TorqueMap
    motions : mapping of str to array, shape (samples,), rad
        Motion of the arm's side, by one of `WAYS`.
    number : int
        The joint, from 0.
    chosen : str
        See `JointResult`.
    """
    models = {RAW: extract(joint)}
    models |= {way: extract_compensated(joint, motion) for way, motion in motions.items()}
    return JointResult(number, joint, models, chosen)


def of_recording(
    recorded: Recording, way: Recording | None, joint: int, clamped: Clamped, chosen: str = ""
) -> JointResult:
    """Extract the models of one joint's recording.

    Parameters
    ----------
    recorded : Recording
        As `session.measure` gives them.
    way : Recording or None
        The way to the clamp.
    joint : int
        From 0.
    clamped : Clamped
    chosen : str
        See `JointResult`.
    """
    found = map_of(recorded, joint)
    motions = {}
    if clamped.environment.any():
        torque = _all_torques(recorded, joint, extract(found))
        motions[CLAMP] = arm_motion_of_torque(clamped.arm, clamped.pose, clamped.environment, torque)[:, joint]
    tool = seen_tool(recorded)
    if tool is not None:
        motions[TOOL] = arm_motion_of_deflection(clamped.arm, clamped.pose, deflection(tool))[:, joint]
    link = _seen_link(recorded, way, joint)
    if link is not None:
        motions[LINK] = link
    return replace(of_map(found, motions, joint, chosen), pose=clamped.number)


def map_of(recorded: Recording, joint: int) -> TorqueMap:
    """Return the torque-position map of a joint, from 0, in its recording."""
    angle, torque = recorded.select([f"angle_{joint + 1}", f"torque_{joint + 1}"]).data.T.astype(float)
    return TorqueMap(angle, torque, recorded.rate)


def seen_tool(recorded: Recording) -> np.ndarray | None:
    """Return the tool's pose, shape (samples, 7), m and unit quaternion w x y z, where it was seen."""
    if "frames_1" in recorded.names:
        return tool_pose(recorded)
    names = [f"pose_{place}" for place in range(1, 8)]
    return recorded.select(names).data.astype(float) if "pose_1" in recorded.names else None


def _seen_link(recorded: Recording, way: Recording | None, joint: int) -> np.ndarray | None:
    """Return the motion of the link, shape (samples,), rad, where a tracker or a simulated robot shows it."""
    if "frames_1" not in recorded.names:
        name = f"link_{joint + 1}"
        return recorded.select([name]).data[:, 0].astype(float) if name in recorded.names else None
    axis = None if way is None else tracked_axis(way, joint)
    return None if axis is None else link_motion(recorded, axis, joint)


def _all_torques(recorded: Recording, joint: int, model: JointModel) -> np.ndarray:
    """Return the torque of the actuated joint's spring, and what the others' motors do in step with it.

    Friction hides a part of the others': a motor that stands still shows none of what its gear bears.
    """
    bears = model.spring_torque(recorded.select([f"angle_{joint + 1}"]).data[:, 0].astype(float)) - model.offset
    names = [name for name in recorded.names if name.startswith("torque_")]
    slopes = slope_over(recorded.select(names).data.astype(float), bears)
    slopes[joint] = 1.0
    return np.outer(bears, slopes)


def slope_over(signals: np.ndarray, bears: np.ndarray) -> np.ndarray:
    """Return the mean of both sides' slopes of signals over a joint's spring torque, a slow drift apart.

    Parameters
    ----------
    signals : array, shape (samples, signals), any unit
    bears : array, shape (samples,), N m

    Returns
    -------
    array, shape (signals,), their unit per N m
    """
    time = np.linspace(-1.0, 1.0, len(bears))
    terms = np.column_stack([np.maximum(bears, 0), np.minimum(bears, 0), np.sign(bears), np.ones(len(bears)), time])
    weights, *_ = np.linalg.lstsq(terms, signals, rcond=None)
    return np.asarray(weights[:2].mean(axis=0))


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
