"""A stage of the population as a Block."""

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.plants.flexure_stage import FlexureStagePlant
from firmware_sim.population.stage_population import STAGES
from firmware_sim.population.stages import draw_stage


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
        self._plant = FlexureStagePlant(rate, self._drawn.plant)

    def process(
        self,
        voltage: np.ndarray,
        force: np.ndarray,
        base: np.ndarray,
        extension: np.ndarray,
        position: np.ndarray,
        absolute: np.ndarray,
    ) -> None:
        """Run it over one frame."""
        self._plant.run(voltage, force, base, extension, position, absolute)
