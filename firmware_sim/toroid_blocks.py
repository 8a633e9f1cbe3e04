"""The toroid's cut as a block, for a cell in one graph."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.plants.options import chosen
from firmware_sim.plants.toroid_cut import ToroidCut, ToroidOptions


@dataclass(eq=False, kw_only=True)
class Toroid(ToroidOptions, Block):
    """A toroid milled from its beginning after every `prepare`; `ToroidCut` says what it models.

    Ports: `tool`, `workpiece` (m, 3), `orientation` (1, 4) in; `force` (N, 3), `moment` (N m, 3) on the robot's tool,
    `plate_force` (N, 3) on the stage's plate, `cut` (m, 3), where the tool is in the workpiece, and `face` (m, 3), how
    the workpiece's face comes towards the stage, out.

    Parameters: those of `ToroidOptions`.
    """

    inputs = (Port("tool", "m", 3), Port("workpiece", "m", 3), Port("orientation", "1", 4))
    outputs = (
        Port("force", "N", 3), Port("moment", "N m", 3), Port("plate_force", "N", 3), Port("cut", "m", 3),
        Port("face", "m", 3),
    )  # fmt: skip

    def prepare(self, rate: float, frames: int) -> None:
        """Draw it."""
        self._plant = ToroidCut(rate, **chosen(self, ToroidOptions))

    def process(
        self,
        tool: np.ndarray,
        workpiece: np.ndarray,
        orientation: np.ndarray,
        force: np.ndarray,
        moment: np.ndarray,
        plate_force: np.ndarray,
        cut: np.ndarray,
        face: np.ndarray,
    ) -> None:
        """Go on for one frame."""
        self._plant.run(tool, workpiece, orientation, force, moment, plate_force, cut, face)
