"""The simulated macro and micro manipulator as a block; the plant itself knows neither blocks nor ports."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.plants.macro_micro import MacroMicroOptions, MacroMicroPlant
from firmware_sim.plants.options import chosen


@dataclass(eq=False, kw_only=True)
class MacroMicro(MacroMicroOptions, Block):
    """The simulated pair, at rest at zero after every `prepare`; `MacroMicroPlant` says what it models.

    Ports: `fast_reference`, `slow_reference` (m) in; `relative`, `fast`, `slow` (m, as measured), `control` (m/s, ahead
    of its saturation) and `position` (m, the relative position itself) out.

    In a loop, wire an output `delayed`: it shows the end of its sample.

    Parameters: those of `MacroMicroOptions`.
    """

    inputs = (Port("fast_reference", "m"), Port("slow_reference", "m"))
    outputs = (
        Port("relative", "m"),
        Port("fast", "m"),
        Port("slow", "m"),
        Port("control", "m/s"),
        Port("position", "m"),
    )

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self._plant = MacroMicroPlant(rate, **chosen(self, MacroMicroOptions))

    def process(
        self,
        fast_reference: np.ndarray,
        slow_reference: np.ndarray,
        relative: np.ndarray,
        fast: np.ndarray,
        slow: np.ndarray,
        control: np.ndarray,
        position: np.ndarray,
    ) -> None:
        """Move it over one frame."""
        self._plant.run(fast_reference, slow_reference, relative, fast, slow, control, position)
