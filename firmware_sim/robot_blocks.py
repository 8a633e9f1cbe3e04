"""The simulated robot as a Block, for a cell in one graph."""

from typing import Any

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.plants.robot import RobotPlant


class RobotArm(Block):
    """A robot: `reference` (rad, 6) of its motors, `force` (N, 3) and `moment` (N m, 3) on its tool in base axes, in.

    Out come `motor_angle` (rad, 6) and `torque` (N m, 6), seen from the arm's side of the gears, `link_angle` (rad, 6),
    and the tool's `position` (m, 3) and `orientation` (1, 4), a unit quaternion w x y z.

    Parameters
    ----------
    options : keywords of `RobotPlant`
    """

    inputs = (Port("reference", "rad", 6), Port("force", "N", 3), Port("moment", "N m", 3))
    outputs = (
        Port("motor_angle", "rad", 6),
        Port("torque", "N m", 6),
        Port("link_angle", "rad", 6),
        Port("position", "m", 3),
        Port("orientation", "1", 4),
    )

    def __init__(self, **options: Any) -> None:
        self._options = options
        self.plant = RobotPlant(**options)

    def prepare(self, rate: float, frames: int) -> None:
        """Put it at rest at home."""
        self.plant = RobotPlant(rate=rate, **self._options)
        self._wrench, self._pose = np.zeros((frames, 6)), np.zeros((frames, 7))

    def process(
        self,
        reference: np.ndarray,
        force: np.ndarray,
        moment: np.ndarray,
        motor_angle: np.ndarray,
        torque: np.ndarray,
        link_angle: np.ndarray,
        position: np.ndarray,
        orientation: np.ndarray,
    ) -> None:
        """Go on for one frame."""
        self._wrench[:, :3], self._wrench[:, 3:] = force, moment
        self.plant.run(reference, self._wrench, motor_angle, torque, link_angle, self._pose)
        position[:], orientation[:] = self._pose[:, :3], self._pose[:, 3:]
