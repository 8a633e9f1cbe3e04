"""The toroid's cut as a block, for a cell in one graph."""

from dataclasses import dataclass

from ctlblocks.block import Block, Port
from firmware_sim.plants.options import chosen
from firmware_sim.plants.toroid_cut import ToroidCut, ToroidOptions
from firmware_sim.run_of import run_of


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
        self.plant = ToroidCut(rate, **chosen(self, ToroidOptions))

    process = run_of(ToroidCut)
