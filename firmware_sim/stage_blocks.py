"""The simulated piezo stage and what disturbs it as blocks; they themselves know neither blocks nor ports."""

from dataclasses import dataclass

from ctlblocks.block import Block, Port
from firmware_sim.plants.milling_disturbance import MillingDisturbance, MillingOptions
from firmware_sim.plants.options import chosen
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from firmware_sim.plants.piezo_stage_options import PiezoStageOptions
from firmware_sim.run_of import run_of


@dataclass(eq=False, kw_only=True)
class PiezoStage(PiezoStageOptions, Block):
    """The simulated piezo stage, at rest at 0 V after every `prepare`; `PiezoStagePlant` says what it models.

    Ports, three wide, x y z: `voltage` (V, of the stacks), `force` (N, on the plate) and `base` (m, of the robot) in;
    `extension` (m, strain gauges), `position` (m, capacitive sensors) and `absolute` (m, laser) out.

    In a loop, wire an output `delayed`: it shows the state at the end of its sample, `delay` samples late.

    Parameters: those of `PiezoStageOptions`.
    """

    inputs = (Port("voltage", "V", 3), Port("force", "N", 3), Port("base", "m", 3))
    outputs = (Port("extension", "m", 3), Port("position", "m", 3), Port("absolute", "m", 3))

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self.plant = PiezoStagePlant(rate, **chosen(self, PiezoStageOptions))

    process = run_of(PiezoStagePlant)


@dataclass(eq=False, kw_only=True)
class Milling(MillingOptions, Block):
    """A cut from its beginning after every `prepare`; `MillingDisturbance` says what it is made of.

    Ports, three wide, x y z: `force` (N, on the stage's plate) and `base` (m, of the robot) out.

    Parameters: those of `MillingOptions`.
    """

    outputs = (Port("force", "N", 3), Port("base", "m", 3))

    def prepare(self, rate: float, frames: int) -> None:
        """Draw the cut."""
        self.plant = MillingDisturbance(rate, **chosen(self, MillingOptions))

    process = run_of(MillingDisturbance)
