"""A real arm in a clamp as a Block: guided motion, soft servo and clamp by its program, torques from a log line."""

import math

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.clamp_program import ClampProgram
from stagectl.robot.clamp_tracker import FRAMES, TrackedLinks
from stagectl.robot.port import RobotPort
from stagectl.robot.port_blocks import JointCommand
from stagectl.robot.program import Torques
from stagectl.wire.robot import RATE


class GuidedArm(Block):
    """The other end of `ClampSearch` over a robot's wires; the tick's clock is the robot's report.

    Ports: `reference` (rad), six wide, `soft` and `clamp` (1 for on) in; `angle` (rad) and `torque` (N m) of the motors
    from one line of the signal log, six wide, `frames` (seven numbers each of base, six links and tool: m and a unit
    quaternion, zeros where unseen), `softened`, `clamped` and `fault` (1 for yes) out.

    In a loop, wire its inputs `delayed`: in its first sample it asks the robot to stay where it is.  Signals that stop
    for longer than `robot.lag`, and a program that refuses, hold the robot by their names.

    Parameters
    ----------
    port : RobotPort, of mode "joints"
        While its fault is latched, a tick raises `RobotFault`.
    program : ClampProgram
    signals : Torques
    links : TrackedLinks or None
        Without a tracker `frames` are zeros.
    """

    inputs = (Port("reference", "rad", 6), Port("soft"), Port("clamp"))
    outputs = (
        Port("angle", "rad", 6),
        Port("torque", "N m", 6),
        Port("frames", "1", 7 * FRAMES),
        Port("softened"),
        Port("clamped"),
        Port("fault"),
    )

    def __init__(self, port: RobotPort, program: ClampProgram, signals: Torques, links: TrackedLinks | None) -> None:
        self.port, self.program, self.signals, self.links = port, program, signals, links
        self._command = JointCommand(port)

    def prepare(self, rate: float, frames: int) -> None:
        """Begin where the robot is."""
        self._command.prepare(rate, frames)
        self._none = np.zeros((frames, 6))
        self._first = True
        self._silent, self._offered, self._losses = 0, 0, self.signals.losses
        self._newest = np.zeros(13)
        self._most = round(self.port.robot.lag * RATE)

    def process(
        self,
        reference: np.ndarray,
        soft: np.ndarray,
        clamp: np.ndarray,
        angle: np.ndarray,
        torque: np.ndarray,
        frames: np.ndarray,
        softened: np.ndarray,
        clamped: np.ndarray,
        fault: np.ndarray,
    ) -> None:
        """Send the newest reference, and fill one frame with what has come."""
        if self._first:
            self._first = False
            self._command.process(self.port.sent[None], self._none)
        else:
            self._command.process(reference, self._none)
        self.program.want(bool(soft[-1, 0] >= 1.0), bool(clamp[-1, 0] >= 1.0))
        newest = self.signals.newest
        if math.isfinite(newest.sum()):  # a line that is down says so by its fault
            self._newest[:] = newest
        angle[:], torque[:] = self._newest[1:7], self._newest[7:]
        frames[:] = 0.0 if self.links is None else self.links.poses.reshape(-1)
        softened[:], clamped[:] = self.program.is_soft, self.program.is_clamped
        fault[:] = 1.0 if self._is_silent() else 0.0

    def _is_silent(self) -> bool:
        """Look whether the signal line still speaks; one that does not holds the robot."""
        offered = self.signals.samples.offered
        self._silent = self._silent + 1 if offered == self._offered else 0
        self._offered = offered
        if self.signals.losses > self._losses:  # also where it is back already: what it said meanwhile is lost
            self.port.hold("the torque signals have stopped: their line is down")
            return True
        if self._silent > self._most:
            limit = self.port.robot.lag
            self.port.hold(f"the torque signals are silent for {self._silent / RATE:.3g} s, must be <= {limit:g} s")
        return self._silent > self._most
