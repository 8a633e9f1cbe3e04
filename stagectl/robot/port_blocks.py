"""The robot port as a Block: where the robot is to be."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.port import RobotPort


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
        if port.robot.mode != "joints":
            raise ValueError(f"robot.mode is {port.robot.mode!r}, must be 'joints' for this Block")
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
