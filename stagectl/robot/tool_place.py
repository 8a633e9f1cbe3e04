"""Joint angles for places of the tool, as a Block: the inverse kinematics of a path that is not known before."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot import tool_place_kernel as kernel
from stagectl.robot.arm import Arm
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
        self._home, self._origin = np.array(home, float), np.array(origin, float)
        self._wanted = forward(arm.with_tool(tool), self._home)[:3, :3].copy()
        self._chain = np.stack([arm.offset, arm.d, arm.a, arm.alpha], axis=1)
        self._tool, self._length = tool, arm.reach + tool

    def prepare(self, rate: float, frames: int) -> None:
        """Be at home."""
        self._angle = self._home.copy()
        self._work, self._pose, self._step = np.zeros((19, 6)), np.zeros((3, 4)), np.zeros((3, 6))

    def process(self, place: np.ndarray, joint_angle: np.ndarray) -> None:
        """Fill one frame."""
        sizes = self._tool, self._length, NEAR_SINGULAR * self._length
        kernel.follow(
            place, joint_angle, self._origin, self._wanted, self._angle, self._chain, *sizes, self._work, self._pose,
            self._step,
        )  # fmt: skip
