"""A vibrator of a seeded family, whole."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from firmware_sim.plants.exciter import Coils, Exciter, ExciterPlant, linear_response, without_distortion
from firmware_sim.plants.mode_drift import Drift
from firmware_sim.plants.reception import Sensors, silent_reception
from firmware_sim.plants.structure import Structure
from firmware_sim.population.distortion import draw_distortion
from firmware_sim.population.draw import Quantity
from firmware_sim.population.flextensionals import draw_flextensional
from firmware_sim.population.free_shells import draw_shell
from firmware_sim.population.machine import Machine, draw_level
from firmware_sim.population.mechanics import DAMPING, FEWEST, HIGHEST, LOWEST, MOST, Mechanics, log_uniform
from firmware_sim.population.references import Wanted, draw_references, needed
from firmware_sim.population.sensing import draw_reception, draw_sensors
from firmware_sim.population.steady_motion import SteadyMotion
from firmware_sim.population.streams import Streams
from firmware_sim.population.surroundings import draw_drift
from firmware_sim.population.two_masses import draw_two_masses

Family = Callable[[Streams, int, int, float, int], Mechanics]
FAMILIES: dict[str, Family] = {
    "shell": draw_shell,
    "lumped": draw_two_masses,
    "flextensional": draw_flextensional,
}
COILS = (0.2, 0.4, 0.2, 0.2)
"""1: of vibrators with one coil, with two, three, four."""
SPARE = 0.15
"""1: of those with more than one coil, that have a sensor less."""
FOR_EACH = 5
"""Modes, beside `FEWEST`, that there are at least for each coil but the first."""
FARTHEST_APART = 300.0
"""1: singular values of G in the worst bin of `BINS`."""
BINS = np.arange(15.0, 651.0)
"""Hz."""
ROUNDING = 1e-6
"""1: what is drawn right at the end of a range is within it, on whichever machine."""
ATTEMPTS = 200
"""Structures drawn until one is within the ranges of the population."""
RESISTANCE, CORNER, BACK_EMF = (1.0, 8.0), (300.0, 3000.0), (0.001, 0.02)
"""Ohm; Hz, R / (2 pi L); and the damping that the back-EMF gives to the mode that it damps most."""


def draw_machine(family: str, seed: int) -> Machine:
    """Draw a vibrator of a seeded family.

    Parameters
    ----------
    family : str
        One of `FAMILIES`.
    seed : int, >= 0
    """
    streams = Streams(seed, "vibrator", family)
    mechanics, first, heard = _mechanics(streams, FAMILIES[family])
    references = draw_references(streams, first)
    sensors, sensing = draw_sensors(streams, heard)
    silent = _silent(streams, mechanics, sensors)
    silent, level = _amplified(streams, silent, references[0])
    loud, distorting = draw_distortion(streams.within("distortion"), silent, SteadyMotion(silent, references[0], level))
    reception, surrounding = draw_reception(streams, sensors, level, references[0].line)
    drift, drifting = draw_drift(streams, mechanics.structure)
    whole = replace(loud, reception=reception, drift=drift)
    structure = mechanics.structure
    return Machine(
        partial(ExciterPlant, whole, seed=seed),
        partial(linear_response, whole),
        (mechanics.coils, heard),
        float((1 / (2 * np.pi * structure.frequency * structure.damping)).max()),
        float(sensors.delay.max()),
        references,
        level,
        (*_said(mechanics, whole), *mechanics.quantities, *distorting, *sensing, *surrounding, *drifting),
    )


def _mechanics(streams: Streams, family: Family) -> tuple[Mechanics, float, int]:
    """Draw structures until one is within the ranges; return the first resonance, Hz, and the sensors, too."""
    coils = 1 + int(streams("coils").choice(4, p=COILS))
    heard = coils - int(coils > 1 and streams("sensors").uniform() < SPARE)
    first = float(log_uniform(streams("first resonance"), LOWEST, HIGHEST))
    modes = int(streams("modes").integers(FEWEST + FOR_EACH * (coils - 1), MOST + 1))
    for attempt in range(ATTEMPTS):
        mechanics = family(streams.within(f"structure {attempt}"), coils, heard, first, modes)
        if _is_within(mechanics.structure, coils):
            return mechanics, first, heard
    raise ValueError(f"none of {ATTEMPTS} structures of this seed is within the ranges of the population")


def _is_within(structure: Structure, coils: int) -> bool:
    damping, modes = structure.damping, len(structure.frequency)
    least, most = DAMPING[0] * (1 - ROUNDING), DAMPING[1] * (1 + ROUNDING)
    if not (FEWEST <= modes <= MOST and least <= damping.min() and damping.max() <= most):
        return False
    return bool((singular_gap(structure, coils) <= FARTHEST_APART).all())


def singular_gap(structure: Structure, coils: int) -> np.ndarray:
    """Return the largest over the smallest singular value of force to acceleration in each bin, shape (BINS,), 1."""
    _, heard = structure.response(2 * np.pi * BINS, 2, coils)
    singular = np.linalg.svd(heard, compute_uv=False)
    gap: np.ndarray = singular[:, 0] / singular[:, -1]
    return gap


def _silent(streams: Streams, mechanics: Mechanics, sensors: Sensors) -> Exciter:
    """Draw coils, and return the vibrator without distortion, hum, noise and drift, at a gain of one."""
    structure, count = mechanics.structure, mechanics.coils
    rng = streams("coil electrics")
    resistance = float(log_uniform(rng, *RESISTANCE)) * (1 + 0.03 * rng.standard_normal(count))
    inductance = resistance / (2 * np.pi * float(log_uniform(rng, *CORNER)))
    damped = np.abs(structure.outlet * structure.inlet)[:count, structure.poles.imag > 0].max()
    factor = np.sqrt(2 * float(log_uniform(streams("back-EMF"), *BACK_EMF)) * resistance.mean() / damped)
    factors, still = factor * (1 + 0.03 * rng.standard_normal(count)), np.zeros(count)
    coils = Coils(factors, resistance, inductance, still, still, 1.0, 0.0, 1)
    return Exciter(
        structure,
        coils,
        without_distortion(count + mechanics.joints),
        silent_reception(sensors),
        Drift(),
    )


def _amplified(streams: Streams, silent: Exciter, wanted: Wanted) -> tuple[Exciter, float]:
    """Draw how much drive a reference needs, and return the vibrator with an amplifier of that gain, and the level."""
    sensitivity, level = draw_level(streams)
    gain = float(np.sqrt(2)) * needed(partial(linear_response, silent), wanted).rms / sensitivity
    return replace(silent, coils=replace(silent.coils, gain=gain)), level


def _said(mechanics: Mechanics, exciter: Exciter) -> tuple[Quantity, ...]:
    structure, coils = mechanics.structure, exciter.coils
    return (
        Quantity("coils", mechanics.coils),
        Quantity("sensors", len(structure.sensors)),
        Quantity("modes", len(structure.frequency)),
        Quantity("first resonance", float(structure.frequency.min()), "Hz"),
        Quantity("last resonance", float(structure.frequency.max()), "Hz"),
        Quantity("least damping", float(structure.damping.min()), "1"),
        Quantity("most damping", float(structure.damping.max()), "1"),
        Quantity("singular values apart", float(singular_gap(structure, mechanics.coils).max()), "1"),
        Quantity("force factor", float(coils.factor.mean()), "N/A"),
        Quantity("resistance", float(coils.resistance.mean()), "ohm"),
        Quantity("amplifier gain", coils.gain, "V/V"),
    )
