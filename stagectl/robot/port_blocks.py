"""The robot port as Blocks."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.port import RobotPort


class JointReport(Block):
    """Hold the robot's newest report: `joint_angle` and `planned_angle` (rad, 6) out; NaN until one has come.

    Parameters
    ----------
    port : RobotPort
        While its fault is latched, a tick raises `RobotFault`.
    """

    outputs = (Port("joint_angle", "rad", 6), Port("planned_angle", "rad", 6))

    def __init__(self, port: RobotPort) -> None:
        self.port = port

    def process(self, joint_angle: np.ndarray, planned_angle: np.ndarray) -> None:
        """Fill one frame."""
        if self.port.reason:
            self.port.refuse_when_latched()
        report = self.port.report
        joint_angle[:] = np.nan if report is None else report.joint_angle
        planned_angle[:] = np.nan if report is None else report.planned_angle


class PoseReport(Block):
    """Hold the tool's pose as the robot says it: `position` (m, 3) and `orientation` (1, 4), a quaternion w x y z, out.

    Parameters
    ----------
    port : RobotPort
        While its fault is latched, a tick raises `RobotFault`.
    """

    outputs = (Port("position", "m", 3), Port("orientation", "1", 4))

    def __init__(self, port: RobotPort) -> None:
        self.port = port

    def process(self, position: np.ndarray, orientation: np.ndarray) -> None:
        """Fill one frame."""
        if self.port.reason:
            self.port.refuse_when_latched()
        report = self.port.report
        position[:] = np.nan if report is None else report.pose[:3]
        orientation[:] = np.nan if report is None else report.pose[3:]


class JointCommand(Block):
    """Send the robot where it is to be: `nominal` (rad, 6), its path, and `correction` (rad, 6), added to it, in.

    The newest sample of a frame counts.  The port holds both against its limits.  Nothing is sent before
    `RobotPort.start` and after a fault.

    Parameters
    ----------
    port : RobotPort, of mode "joints"
        While its fault is latched, a tick raises `RobotFault`.
    """

    inputs = (Port("nominal", "rad", 6), Port("correction", "rad", 6))

    def __init__(self, port: RobotPort) -> None:
        _refuse_other_mode(port, "joints")
        self.port, self._wanted = port, port.conversation.wanted

    def prepare(self, rate: float, frames: int) -> None:
        """Allocate."""
        self._corrected = np.zeros(6)

    def process(self, nominal: np.ndarray, correction: np.ndarray) -> None:
        """Hand over the newest sample."""
        if self.port.reason:
            self.port.refuse_when_latched()
        np.add(nominal[-1], correction[-1], out=self._corrected)
        self._wanted.put(nominal[-1], self._corrected)


class PoseCommand(Block):
    """Send the robot where its tool is to be: `position` (m, 3), `orientation` (1, 4) and `correction` (m, 3) in.

    The correction is in the axes of the base.  The newest sample of a frame counts.

    Parameters
    ----------
    port : RobotPort, of mode "pose"
        While its fault is latched, a tick raises `RobotFault`.
    """

    inputs = (Port("position", "m", 3), Port("orientation", "1", 4), Port("correction", "m", 3))

    def __init__(self, port: RobotPort) -> None:
        _refuse_other_mode(port, "pose")
        self.port, self._wanted = port, port.conversation.wanted

    def prepare(self, rate: float, frames: int) -> None:
        """Allocate."""
        self._nominal, self._corrected = np.zeros(7), np.zeros(7)

    def process(self, position: np.ndarray, orientation: np.ndarray, correction: np.ndarray) -> None:
        """Hand over the newest sample."""
        if self.port.reason:
            self.port.refuse_when_latched()
        self._nominal[:3], self._nominal[3:] = position[-1], orientation[-1]
        self._corrected[:] = self._nominal
        self._corrected[:3] += correction[-1]
        self._wanted.put(self._nominal, self._corrected)


def _refuse_other_mode(port: RobotPort, mode: str) -> None:
    if port.robot.mode != mode:
        raise ValueError(f"robot.mode is {port.robot.mode!r}, must be {mode!r} for this Block")
