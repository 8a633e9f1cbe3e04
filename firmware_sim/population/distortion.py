"""How a vibrator distorts: any mix of six mechanisms, each as loud as is drawn at the reference level.

How loud a mechanism will be is worked out at first order: the motion is what the linear structure would make of the
reference, the forces are what the nonlinear laws add to it, and the overtones are what the structure makes of those.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from firmware_sim.plants.exciter import Coils, Exciter, without_distortion
from firmware_sim.plants.exciter_kernel import (
    CONTACT,
    COULOMB,
    CUBIC,
    FAR,
    LUGRE,
    NEAR,
    SAG,
    STIFFNESS,
    TRAVEL,
)
from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.steady_motion import SteadyMotion
from firmware_sim.population.streams import Streams

MECHANISMS = ("force factor", "stiffening", "Dahl friction", "LuGre friction", "backlash", "soft clipping")
LOUDEST = (-60.0, 0.0)
"""dB re the reference, of the loudest mechanism."""
NONE, PRESENT, SPREAD = 0.08, 0.5, 25.0
"""1: vibrators without distortion, and mechanisms in the others; dB by which these are fainter than the loudest."""
STRONGEST = 3.0
"""Times the coils' force: the most that friction or a contact may have."""
STABLE = 0.2
"""1, of stiffness x step^2 / mass at `STEP`: what a law may have where it is steepest."""
STEP = 1 / 44_100


def draw_distortion(streams: Streams, exciter: Exciter, motion: SteadyMotion) -> tuple[Exciter, tuple[Quantity, ...]]:
    """Draw which mechanisms there are, how loud, and where, and return the vibrator with them.

    Parameters
    ----------
    streams : Streams
    exciter : Exciter
        Without distortion.
    motion : SteadyMotion
        At the reference level.
    """
    wanted = _levels(streams)
    coils, laws = exciter.coils, without_distortion(len(exciter.elements))
    found: dict[str, float] = {}
    for name, level in wanted.items():
        part = streams.within(name)
        if name == "force factor":
            coils, found[name] = _field(part, coils, motion, level)
        elif name == "soft clipping":
            coils, found[name] = _clip(part, coils, motion, level)
        else:
            places = _places(part, name, len(coils.factor), len(laws))
            found[name] = _elements(LAWS[name], part, motion, level, laws, places)
    _soften(laws, exciter)
    said = tuple(Quantity(f"distortion by {name}", 20 * np.log10(level), "dB") for name, level in found.items())
    return replace(exciter, coils=coils, elements=laws), said


def _levels(streams: Streams) -> dict[str, float]:
    """Draw how loud each mechanism is that there is, 1 re the reference."""
    if streams("any distortion").uniform() < NONE:
        return {}
    rng = streams("distortion")
    loudest, present = rng.uniform(*LOUDEST), rng.uniform(size=len(MECHANISMS)) < PRESENT
    first, fainter = int(rng.integers(len(MECHANISMS))), rng.uniform(0, SPREAD, len(MECHANISMS))
    present[first], fainter[first] = True, 0.0
    each = zip(MECHANISMS, present, fainter, strict=True)
    return {name: float(10 ** ((loudest - down) / 20)) for name, there, down in each if there}


def _places(streams: Streams, name: str, coils: int, elements: int) -> range:
    """Draw which elements have a law: the coils' suspensions, which stiffen, or the joints, or all."""
    which = int(streams("place").integers(3))
    if name == "stiffening" or which == 0:
        return range(coils)
    return range(coils, elements) if which == 1 else range(elements)


@dataclass(frozen=True)
class Scale:
    """How far (m) and fast (m/s) an element moves at the reference level, and the coils' force (N)."""

    far: float
    fast: float
    force: float


Law = Callable[[np.random.Generator, Scale], np.ndarray]
"""Makes a row of elements."""


def _elements(
    make: Law, streams: Streams, motion: SteadyMotion, level: float, laws: np.ndarray, places: range
) -> float:
    """Put a law into elements so that together they are as loud as wanted, or as they may be; return how loud."""
    first = laws.shape[0]
    drawn = {}
    for element in places:
        port = motion.displacement.shape[2] - first + element
        far, fast = (float(np.abs(each[:, :, port]).max()) for each in (motion.displacement, motion.velocity))
        drawn[element] = make(streams("law"), Scale(far, fast, motion.force))
    alone = motion.elements_level(drawn)
    factor = min(level / max(alone, 1e-30), STRONGEST)
    for element, law in drawn.items():
        law[SCALED] *= factor
        laws[element, law != 0] = law[law != 0]
    return factor * alone


SCALED = np.array([CUBIC, COULOMB, LUGRE, LUGRE + 1, LUGRE + 2, LUGRE + 3, LUGRE + 4, STIFFNESS, CONTACT])
"""Columns to which a law's force is proportional."""


def _stiffening(rng: np.random.Generator, at: Scale) -> np.ndarray:
    law = np.zeros(14)
    law[CUBIC], law[SAG] = at.force / at.far**3, at.far * rng.uniform(0.0, 0.5)
    return law


def _dahl(rng: np.random.Generator, at: Scale) -> np.ndarray:
    law = np.zeros(14)
    law[COULOMB], law[TRAVEL] = at.force, at.far * log_uniform(rng, 0.003, 0.3)
    return law


def _lugre(rng: np.random.Generator, at: Scale) -> np.ndarray:
    law = np.zeros(14)
    bristles, stribeck = at.far * log_uniform(rng, 0.003, 0.1), at.fast * rng.uniform(0.02, 0.2)
    stiffness = at.force / bristles
    damping = rng.uniform(0.0, 1.0) * stiffness * bristles / stribeck
    viscous = rng.uniform(0.0, 0.1) * at.force / at.fast
    law[LUGRE : LUGRE + 6] = stiffness, damping, viscous, at.force, at.force * rng.uniform(1.1, 1.8), stribeck
    return law


def _backlash(rng: np.random.Generator, at: Scale) -> np.ndarray:
    law = np.zeros(14)
    law[STIFFNESS] = at.force / at.far
    law[NEAR], law[FAR] = -at.far * rng.uniform(0.2, 0.8), at.far * rng.uniform(0.2, 0.8)
    law[CONTACT] = law[STIFFNESS] * at.far / at.fast * rng.uniform(0.0, 0.1)
    return law


LAWS: dict[str, Law] = {
    "stiffening": _stiffening,
    "Dahl friction": _dahl,
    "LuGre friction": _lugre,
    "backlash": _backlash,
}


def _field(streams: Streams, coils: Coils, motion: SteadyMotion, level: float) -> tuple[Coils, float]:
    """Find how narrow the magnets' fields are."""
    far = float(np.abs(motion.displacement[:, :, : len(coils.factor)]).max())
    part = streams("law").uniform(-0.3, 0.3)
    width = found(lambda width: motion.field_level(part * width, width), level, 0.7 * far, 300 * far)
    count = len(coils.factor)
    wide = replace(coils, offset=np.full(count, part * width), width=np.full(count, width))
    return wide, motion.field_level(part * width, width)


def _clip(streams: Streams, coils: Coils, motion: SteadyMotion, level: float) -> tuple[Coils, float]:
    """Find where the amplifiers clip."""
    high = float(np.abs(motion.voltage).max())
    sharpness = int(streams("law").choice([1, 2, 4]))
    clip = found(lambda clip: motion.clip_level(clip, sharpness), level, 0.9 * high, 300 * high)
    return replace(coils, clip=clip, sharpness=sharpness), motion.clip_level(clip, sharpness)


def found(level_at: Callable[[float], float], level: float, low: float, high: float) -> float:
    """Return the width at which a level that falls with it is as wanted, or the nearest within limits, any unit."""
    for _ in range(24):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if level_at(middle) > level else (low, middle)
    return float(np.sqrt(low * high))


def _soften(laws: np.ndarray, exciter: Exciter) -> None:
    """Keep what is steep in the laws so soft that a step of the simulation follows it."""
    structure, coils = exciter.structure, len(exciter.coils.factor)
    light = (structure.outlet * structure.poles * structure.inlet).real.sum(axis=1)[coils:]
    steepest = STABLE / (np.maximum(light, 1e-12) * STEP**2)
    dahl = laws[:, COULOMB] > 0
    laws[dahl, TRAVEL] = np.maximum(laws[dahl, TRAVEL], laws[dahl, COULOMB] / steepest[dahl])
    laws[:, LUGRE] = np.minimum(laws[:, LUGRE], steepest)
    laws[:, LUGRE + 1] = np.minimum(laws[:, LUGRE + 1], steepest * STEP)
    laws[:, STIFFNESS] = np.minimum(laws[:, STIFFNESS], steepest)
    laws[:, CONTACT] = np.minimum(laws[:, CONTACT], steepest * STEP)
