"""The vibrators of the population: the Block for a rig file, and the keys of the rig file that fit it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.population.draw import Draw, Population, Quantity
from firmware_sim.population.machine import Machine
from firmware_sim.population.measured_draw import draw_measured
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.moving_coil_draw import draw_moving_coil
from firmware_sim.population.references import Need, Respond, Wanted, needed
from firmware_sim.population.streams import Streams
from firmware_sim.population.vibrator_draw import FAMILIES, draw_machine

MEASURED, MOVING_COIL = "measured", "moving-coil"
NAMED: dict[str, Callable[[str, int], Machine]] = {MEASURED: draw_measured, MOVING_COIL: draw_moving_coil}
"""Families that are drawn only by name: no seed chooses them."""
PLANT = "firmware_sim.population:Vibrator"
HEADROOM, LARGEST_PEAK = (2.0, 8.0), 900.0
"""1: the drive's limit over the peak that the reference needs; V."""
RMS, SLEW, FULL_SCALE = 5 / 9, 2222.0, 1.1
"""1, 1/s and 1: the other limits, and the converter's full scale, over the peak, as in the example rig file."""
MARGIN = 40.0
"""1: the sensors' full scale over the reference level, at least."""
CREST = 5.0
"""1: the largest peak of a multisine's response over its rms."""
PRELOAD, PROBE = 1.94, 0.28
"""1: over the rms of the drive, as in the example rig file."""
TAIL, RING = (0.4, 3.0), 2.3
"""s, and time constants of the slowest decay, to a tenth."""
PROBED = np.arange(15.0, 650.5, 0.5)
"""Hz."""


@dataclass(eq=False, kw_only=True)
class Vibrator(Block):
    """A vibrator of the population, at rest after every `prepare`.

    `ExciterPlant` says what the seeded families model, `MovingCoilPlant` what the family `moving-coil` does.

    Ports: `drive` (V) in, as wide as it has coils; `response` (m/s^2) out, as wide as it has sensors.

    Parameters
    ----------
    seed : int, >= 0
    family : str
        The seed's own if empty.

    Raises
    ------
    ValueError : there is no such family, or the seed is none; of `measured` its files are not there.
    """

    seed: int
    family: str = ""

    def __post_init__(self) -> None:
        """Draw it."""
        self._machine = drawn_machine(VIBRATORS.family(self.seed, self.family), self.seed)
        drives, heard = self._machine.widths
        self.inputs = (Port("drive", "V", drives),)
        self.outputs = (Port("response", "m/s^2", heard),)

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self._plant = self._machine.build(rate)

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Run it over one frame."""
        self._plant.run(drive, response)


def drawn_machine(family: str, seed: int) -> Machine:
    """Draw a vibrator of any family."""
    return NAMED.get(family, draw_machine)(family, seed)


def draw_vibrator(family: str, seed: int) -> Draw:
    """Draw a vibrator and the keys of a rig file that fit it."""
    machine = drawn_machine(family, seed)
    needs = [needed(machine.respond, wanted) for wanted in machine.references]
    need, level = needs[0], machine.level
    most = machine.most or (np.inf,) * len(needs)
    levels = [rounded(min(level * min(1.0, need.peak / each.peak), top)) for each, top in zip(needs, most, strict=True)]
    head = float(log_uniform(Streams(seed, "vibrator", family)("head-room"), *HEADROOM))
    peak = rounded(min(head * level * need.peak, LARGEST_PEAK))
    reach = (
        Quantity("drive needed, peak", level * need.peak, "V"),
        Quantity("drive needed, rms", level * need.rms, "V"),
        Quantity("drive needed over reference, rms", need.rms * float(np.sqrt(2)), "V per m/s^2"),
        *(Quantity(f"reference {n + 1}", wanted.text) for n, wanted in enumerate(machine.references)),
        *(Quantity(f"level of reference {n + 1}", size, "m/s^2") for n, size in enumerate(levels)),
    )
    keys = _wiring(machine, family, seed) | _limits(peak) | _levels(machine, need)
    keys |= {"simulator.plant": PLANT, "simulator.options.seed": seed, "simulator.options.family": family}
    return Draw("vibrator", family, seed, (*machine.quantities, *reach), keys)


def rounded(value: float) -> float:
    """Return a number with four significant digits."""
    return float(f"{value:.4g}")


def _wiring(machine: Machine, family: str, seed: int) -> dict[str, Any]:
    drives, heard = machine.widths
    return {
        "rig.name": f"vibrator-{family}-{seed}",
        "audio.drive_channels": list(range(1, drives + 1)),
        "audio.response_channels": list(range(1, heard + 1)),
        "audio.loopback_output": drives + 1,
        "audio.loopback_input": heard + 1,
    }


def _limits(peak: float) -> dict[str, Any]:
    return {
        "audio.output_full_scale": rounded(FULL_SCALE * peak),
        "limits.peak": peak,
        "limits.rms": rounded(RMS * peak),
        "limits.slew": rounded(SLEW * peak),
    }


def _levels(machine: Machine, need: Need) -> dict[str, Any]:
    """Return the keys that scale with the reference: itself, what the sensors reach to, what calibrates it."""
    wanted, level = machine.references[0], machine.level
    operating, band = need.rms * level, _preload_band(wanted)
    loudest = CREST * operating * _loudest(machine.respond, band)
    return {
        "audio.input_full_scale": rounded(max(MARGIN * level, loudest)),
        "reference.signal": wanted.text,
        "reference.amplitude": level,
        "shot.tail": rounded(min(max(TAIL[0], RING * machine.rings) + machine.delay, TAIL[1])),
        "characterisation.preload": rounded(PRELOAD * operating),
        "characterisation.probe": rounded(PROBE * operating),
        "characterisation.operating": rounded(operating),
        "characterisation.preload_band": list(band),
    }


def _preload_band(wanted: Wanted) -> tuple[float, float]:
    if wanted.first == wanted.last:
        return rounded(0.75 * wanted.first), rounded(1.5 * wanted.last)
    return float(wanted.first), float(wanted.last)


def _loudest(respond: Respond, band: tuple[float, float]) -> float:
    """Return the rms that a drive of 1 V rms, spread over a band, gives at the loudest sensor, m/s^2."""
    inside = PROBED[(PROBED >= band[0]) & (PROBED <= band[1])]
    response = np.abs(respond(inside)).sum(axis=2)
    return float(np.sqrt((response**2).mean(axis=0)).max())


VIBRATORS = Population("vibrator", tuple(FAMILIES), draw_vibrator, tuple(NAMED))
