"""Cartesian corrections of the tool as corrections of the joints, as a Block."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.arm import Arm
from stagectl.robot.cartesian_kernel import TOOL_ARM, correct
from stagectl.robot.kinematics import NEAR_SINGULAR


class CartesianCorrection(Block):
    """Turn what the tool is to be moved by into what the joints are.

    In: `joint_angle` (rad, 6), where the arm is; `translation` (m, 3) and `rotation` (rad, 3) of the tool, in axes of
    the base.  Out: `correction` (rad, 6).  How large corrections may be is the port's affair, after everything else.

    Parameters
    ----------
    arm : Arm, of six joints
    tool : float, m, from the flange along its axis to the tool point

    Source
    ------
    Sörnmo 2015, eq. (2.6).

    Departs
    -------
    Near a singularity the inverse is damped (Nakamura and Hanafusa, J. Dyn. Sys. Meas. Control 108, 1986), all
    directions alike: the smallest singular value is bounded from below by the trace of the inverse, not computed.
    """

    inputs = (Port("joint_angle", "rad", 6), Port("translation", "m", 3), Port("rotation", "rad", 3))
    outputs = (Port("correction", "rad", 6),)

    def __init__(self, arm: Arm, tool: float) -> None:
        if arm.joints != 6:
            raise ValueError(f"{arm.name} has {arm.joints} joints, must have 6")
        self._arm, length = np.zeros(1, TOOL_ARM), arm.reach + tool
        self._arm["chain"] = np.stack([arm.offset, arm.d, arm.a, arm.alpha], axis=1)
        self._arm["tool"], self._arm["length"], self._arm["least"] = tool, length, NEAR_SINGULAR * length

    def process(
        self, joint_angle: np.ndarray, translation: np.ndarray, rotation: np.ndarray, correction: np.ndarray
    ) -> None:
        """Fill one frame."""
        correct(joint_angle, translation, rotation, correction, self._arm)
