"""A stage of the population as a Block."""

from ctlblocks.block import Block, Port
from firmware_sim.plants.flexure_stage import FlexureStagePlant
from firmware_sim.population.stage_population import STAGES
from firmware_sim.population.stages import draw_stage
from firmware_sim.run_of import run_of


class Stage(Block):
    """A stage drawn by its seed, at rest at its lowest voltages after every `prepare`; see `FlexureStagePlant`.

    Ports, three wide, x y z: `voltage` (V, of the stacks), `force` (N, on the plate) and `base` (m, of the robot) in;
    `extension` (m, strain gauges), `position` (m, capacitive sensors) and `absolute` (m, laser) out.

    In a loop, wire an output `delayed`: it shows the state at the end of its sample, or an earlier one.

    Parameters
    ----------
    seed : int
    family : str
        Of its hysteresis; the seed's own without.
    """

    inputs = (Port("voltage", "V", 3), Port("force", "N", 3), Port("base", "m", 3))
    outputs = (Port("extension", "m", 3), Port("position", "m", 3), Port("absolute", "m", 3))

    def __init__(self, *, seed: int = 1, family: str = "") -> None:
        self._drawn = draw_stage(seed, STAGES.family(seed, family))

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self.plant = FlexureStagePlant(rate, self._drawn.plant)

    process = run_of(FlexureStagePlant)
