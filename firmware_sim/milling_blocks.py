"""The cut in a block of material as a Block, for a cell in one graph."""

from dataclasses import dataclass

from ctlblocks.block import Block, Port
from firmware_sim.plants.milling import PocketMilling, PocketOptions
from firmware_sim.plants.options import chosen
from firmware_sim.run_of import run_of


@dataclass(eq=False, kw_only=True)
class PocketCut(PocketOptions, Block):
    """A fresh block to mill after every `prepare`; `PocketMilling` says what it models.

    Ports: `tool` (m, 3), where the tip really is in the base, and `give` (m/N, 9), by what a force moves it at once,
    row by row, in; `force` (N, 3) and `moment` (N m, 3) on the tool about its tip, averaged over a turn, and
    `teeth_force` (N, 3), the force with its teeth, in axes of the base, out.
    The block's top is level, its middle at `origin`.

    Wire `tool` and `give` from a robot, `force` and `moment` to it, `delayed`, and `teeth_force` to a force sensor.

    Parameters: those of `PocketOptions`.
    """

    inputs = (Port("tool", "m", 3), Port("give", "m/N", 9))
    outputs = (Port("force", "N", 3), Port("moment", "N m", 3), Port("teeth_force", "N", 3))

    def prepare(self, rate: float, frames: int) -> None:
        """Clamp it."""
        self.plant = PocketMilling(rate, **chosen(self, PocketOptions))

    process = run_of(PocketMilling)
