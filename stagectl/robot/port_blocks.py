"""The robot port as Blocks, and the clock that the robot's reports are."""

from collections.abc import Callable

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.graph import Graph
from stagectl.link.bus import LinkError
from stagectl.link.priority import real_time
from stagectl.robot.port import RobotPort
from stagectl.wire.egm import RATE


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


def run_with_robot(graph: Graph, port: RobotPort, ticks: int, stopped: Callable[[], bool] = lambda: False) -> int:
    """Tick a prepared graph once for each report of the robot, `ticks` times or until `stopped`; return the ticks run.

    Parameters
    ----------
    graph : Graph, of 250 samples/s and one frame a tick
    port : RobotPort, open
    ticks : int
    stopped : callable() -> bool

    Raises
    ------
    ValueError : the graph has another rate, or more than one frame a tick.
    RobotFault : a fault has latched.
    LinkError : no report has come for `robot.patience`.
    """
    if graph.frames != 1 or graph.rate != RATE:
        raise ValueError(f"the graph has {graph.frames} frames at {graph.rate:g}/s, must have 1 at {RATE:g}/s")
    with real_time():
        reports = port.counts.received
        for done in range(ticks):
            if stopped():
                return done
            reports += 1
            if not port.wait(reports, port.robot.patience):
                port.refuse_when_latched()
                raise LinkError(f"no report from the robot within {port.robot.patience:g} s")
            graph.tick()
            port.flush()
    return ticks


def _refuse_other_mode(port: RobotPort, mode: str) -> None:
    if port.robot.mode != mode:
        raise ValueError(f"robot.mode is {port.robot.mode!r}, must be {mode!r} for this Block")
