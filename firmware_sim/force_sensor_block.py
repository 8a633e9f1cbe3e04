"""The force sensor as a block: what it sends of the force on the tool, as numbers instead of bytes."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.plants.force_sensor import ForceSensorOptions, ForceSensorPlant
from firmware_sim.plants.options import chosen


@dataclass(eq=False, kw_only=True)
class ForceSensor(ForceSensorOptions, Block):
    """The sensor; `ForceSensorPlant` says what it models.

    Ports: `force` (N, 3) and `moment` (N m, 3) on the tool in; `measured` (1, 6: N and N m), the newest record, its
    number `sample` and its `status` (1; 0 for healthy), out.

    Parameters: those of `ForceSensorOptions`.
    """

    inputs = (Port("force", "N", 3), Port("moment", "N m", 3))
    outputs = (Port("measured", "1", 6), Port("sample"), Port("status"))

    def prepare(self, rate: float, frames: int) -> None:
        """Draw it, with nothing sent."""
        self.plant, self._wrench = ForceSensorPlant(rate, **chosen(self, ForceSensorOptions)), np.zeros((frames, 6))

    def process(
        self, force: np.ndarray, moment: np.ndarray, measured: np.ndarray, sample: np.ndarray, status: np.ndarray
    ) -> None:
        """Go on for one frame."""
        self._wrench[:, :3], self._wrench[:, 3:] = force, moment
        self.plant.run(self._wrench, measured, sample, status)
