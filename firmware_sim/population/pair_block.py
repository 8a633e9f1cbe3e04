"""A macro and a micro manipulator of the population as a Block."""

from collections.abc import Sequence
from dataclasses import replace

from ctlblocks.block import Block, Port
from firmware_sim.plants.manipulator_pair import ManipulatorPairPlant
from firmware_sim.population.pair_population import PAIRS
from firmware_sim.population.pairs import draw_pair
from firmware_sim.run_of import run_of


class Pair(Block):
    """A pair drawn by its seed, at rest at zero after every `prepare`; `ManipulatorPairPlant` says what it models.

    Ports: `fast_reference`, `slow_reference` (m) in; `relative`, `fast`, `slow` (m, as measured), `control` (m/s, ahead
    of its saturation) and `position` (m, the relative position itself) out.

    In a loop, wire an output `delayed`: it shows the end of its sample.

    Parameters
    ----------
    seed : int
    family : str
        Of the macro manipulator's arm; the seed's own without.
    noise : float, m, optional
        Rms of every sensor, in place of what is drawn.
    gains : sequence of (float, float), s and 1
        From when on the process gain is which multiple of its own.
    disturbance, disturbed_at : float, m and s
        A step of the relative position, and when it comes.
    """

    inputs = (Port("fast_reference", "m"), Port("slow_reference", "m"))
    outputs = (
        Port("relative", "m"), Port("fast", "m"), Port("slow", "m"), Port("control", "m/s"), Port("position", "m"),
    )  # fmt: skip

    def __init__(
        self,
        *,
        seed: int = 1,
        family: str = "",
        noise: float | None = None,
        gains: Sequence[tuple[float, float]] = (),
        disturbance: float = 0.0,
        disturbed_at: float = 0.0,
    ) -> None:
        made = draw_pair(seed, PAIRS.family(seed, family)).plant
        self._pair = made if noise is None else replace(made, noise=(noise,) * 3)
        self._events = tuple(gains), disturbance, disturbed_at

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self.plant = ManipulatorPairPlant(rate, self._pair, *self._events)

    process = run_of(ManipulatorPairPlant)
