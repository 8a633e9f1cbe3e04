"""The fed tool as a block."""

from dataclasses import dataclass

from ctlblocks.block import Block, Port
from firmware_sim.plants.feed_process import FeedOptions, FeedProcess
from firmware_sim.plants.options import chosen
from firmware_sim.run_of import run_of


@dataclass(eq=False, kw_only=True)
class FedTool(FeedOptions, Block):
    """A tool fed into a workpiece, at its beginning after every `prepare`; `FeedProcess` says what it models.

    Ports: `asked` (m/s) in; `velocity` (m/s), `force` (N, 2), `true_force` (N, 2), `kappa` (m/(N s)), `beta` (1) out.

    In a loop, wire an output `delayed`: it shows the end of its sample.

    Parameters: those of `FeedOptions`.
    """

    inputs = (Port("asked", "m/s"),)
    outputs = (
        Port("velocity", "m/s"), Port("force", "N", 2), Port("true_force", "N", 2), Port("kappa", "m/(N s)"),
        Port("beta"),
    )  # fmt: skip

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew."""
        self.plant = FeedProcess(rate, **chosen(self, FeedOptions))

    process = run_of(FeedProcess)
