"""The cut in oak as a Block, for a cell in one graph."""

from dataclasses import dataclass

from ctlblocks.block import Block, Port
from firmware_sim.plants.oak import OakMilling, OakOptions
from firmware_sim.plants.options import chosen
from firmware_sim.run_of import run_of


@dataclass(eq=False, kw_only=True)
class OakCut(OakOptions, Block):
    """A fresh piece of oak to mill after every `prepare`; `OakMilling` says what it models.

    Ports: `tool` (m, 3), where the tip really is in the base, in; `force` (N, 3) and `moment` (N m, 3) on the tool
    about its tip, averaged over a turn, `teeth_force` (N, 3), `kappa` (m/(N s)) and `beta` (1), as they are, out.

    Wire `force` and `moment` to a robot, `delayed`, and `teeth_force` to a force sensor.

    Parameters: those of `OakOptions`.
    """

    inputs = (Port("tool", "m", 3),)
    outputs = (
        Port("force", "N", 3), Port("moment", "N m", 3), Port("teeth_force", "N", 3), Port("kappa", "m/(N s)"),
        Port("beta"),
    )  # fmt: skip

    def prepare(self, rate: float, frames: int) -> None:
        """Clamp it."""
        self.plant = OakMilling(rate, **chosen(self, OakOptions))

    process = run_of(OakMilling)
