"""The simulated macro and micro manipulator as a block; the plant itself knows neither blocks nor ports."""

from dataclasses import dataclass

from ctlblocks.block import Block, Port
from firmware_sim.plants.macro_micro import MacroMicroOptions, MacroMicroPlant
from firmware_sim.plants.options import chosen
from firmware_sim.run_of import run_of


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
        self.plant = MacroMicroPlant(rate, **chosen(self, MacroMicroOptions))

    process = run_of(MacroMicroPlant)
