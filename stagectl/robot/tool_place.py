"""Joint angles for places of the tool, as a Block: the inverse kinematics of a path that is not known before."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot import tool_place_kernel as kernel
from stagectl.robot.arm import Arm
from stagectl.robot.cartesian_kernel import TOOL_ARM
from stagectl.robot.kinematics import NEAR_SINGULAR, forward


class ToolPlace(Block):
    """Turn the tool's place into joint angles, its direction as at the beginning.

    A step of Newton's method a sample, from the angles before: places some 0.1 mm apart are met to nanometres.

    Ports: `place` (m, 3), from `origin` in axes of the base, in; `joint_angle` (rad, 6) out.

    Parameters
    ----------
    arm : Arm, of six joints
    tool : float, m, from the flange along its axis to the tool point
    home : array, shape (6,), rad
        Where it begins.
    origin : array, shape (3,), m

    Raises
    ------
    ValueError : an arm of other joints, or a home outside its limits.
    """

    inputs = (Port("place", "m", 3),)
    outputs = (Port("joint_angle", "rad", 6),)

    def __init__(self, arm: Arm, tool: float, home: np.ndarray, origin: np.ndarray) -> None:
        if arm.joints != 6:
            raise ValueError(f"{arm.name} has {arm.joints} joints, must have 6")
        arm.refuse_outside(np.asarray(home, float)[None])
        self._home, self._way = np.array(home, float), np.zeros(1, kernel.WAY)
        self._way["origin"] = origin
        self._way["wanted"] = forward(arm.with_tool(tool), self._home)[:3, :3]
        self._arm, length = np.zeros(1, TOOL_ARM), arm.reach + tool
        self._arm["chain"] = np.stack([arm.offset, arm.d, arm.a, arm.alpha], axis=1)
        self._arm["tool"], self._arm["length"], self._arm["least"] = tool, length, NEAR_SINGULAR * length

    def prepare(self, rate: float, frames: int) -> None:
        """Be at home."""
        self._way["angle"] = self._home

    def process(self, place: np.ndarray, joint_angle: np.ndarray) -> None:
        """Fill one frame."""
        kernel.follow(place, joint_angle, self._way, self._arm)
