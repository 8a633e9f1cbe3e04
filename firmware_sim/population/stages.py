"""Stages drawn by seed: their hysteresis is the family, all else differs from stage to stage."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants import creep as creeping
from firmware_sim.plants import stack_hysteresis
from firmware_sim.plants.creep import Creep
from firmware_sim.plants.flexure_stage import FlexureStage, Guide, Modes, Sensor, Stack
from firmware_sim.plants.stack_hysteresis import Hysteresis
from firmware_sim.population.stage_modes import draw_modes
from firmware_sim.population.streams import Streams

KIND = "stage"
FAMILIES = ("bouc-wen", "prandtl-ishlinskii", "maxwell-slip", "lugre-guide")
TRAVEL = 30e-6, 500e-6
"""m, of the plate over the whole range of the voltage."""
STROKE, LEVER = (8e-6, 120e-6), (1.0, 10.0)
"""m of the free stacks, and how much further the plate goes."""
VOLTAGES = 120.0, 150.0, 200.0, 500.0, 1000.0
"""V, of amplifiers for stacks."""
CHANGE = 0.05, 0.30
"""1: the slope of expansion over voltage is within so much of its mean."""
CREEPS = "logarithmic", "chain", "power law"
AMPLIFIER, LAG, FILTER = (300.0, 3000.0), (80.0, 800.0), (500.0, 5000.0)
"""Hz, corners: of the amplifier, of the second lag where there is one, of a sensor's low-passes where it has any."""
LAGS, FILTERS = 0.5, 0.7
"""Of stages have a second lag; of sensors have filters."""
GAUGE_NOISE, PLATE_NOISE = (3e-5, 3e-4), (2e-5, 2e-4)
"""1: rms over the range."""
LASER_NOISE, LASER_STEP = (20e-9, 200e-9), (10e-9, 200e-9)
LASER_RATES = 2_500.0, 5_000.0, 10_000.0, 50_000.0
DELAY = 4
"""Samples, fewer than which a sensor is late."""


@dataclass(frozen=True)
class DrawnStage:
    """A stage, and what of its draw is not among the plant's own numbers.

    Parameters
    ----------
    plant : FlexureStage
    family, creep, structure : str
        The kinds of hysteresis and creep, and of the path from stack to plate.
    travel, lever : float, m and 1
        The shortest of the three axes over the voltage's range, and how much further the plates go than free stacks.
    change : float, 1
    """

    plant: FlexureStage
    family: str
    creep: str
    structure: str
    travel: float
    lever: float
    change: float


def draw_stage(seed: int, family: str) -> DrawnStage:
    """Draw a stage.

    Parameters
    ----------
    seed : int
    family : str, of `FAMILIES`
    """
    streams = Streams(seed, KIND, family)
    travel = _log_uniform(streams("travel"), *TRAVEL)
    stroke = _log_uniform(streams("stroke"), max(STROKE[0], travel / LEVER[1]), min(STROKE[1], travel / LEVER[0]))
    longer = streams("axes").uniform(1.0, 1.15, 3)
    longer /= longer.min()
    modes, structure = draw_modes(streams, travel / stroke)
    change = float(streams("hysteresis").uniform(*CHANGE))
    creep = str(streams("creep").choice(CREEPS))
    stacks = _stacks(streams, family, change, creep, stroke * longer / np.diag(modes.gains()[1]) * travel / stroke)
    guides = _guides(streams, change, modes, travel) if family == "lugre-guide" else ()
    plant = FlexureStage(stacks, guides, modes, *_sensors(streams, travel, stacks, modes), *_late(streams), seed)
    return DrawnStage(plant, family, creep, structure, travel, travel / stroke, change)


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(low * (high / low) ** rng.uniform())


def _stacks(
    streams: Streams, family: str, change: float, creep: str, strokes: np.ndarray
) -> tuple[Stack, Stack, Stack]:
    """Draw three stacks of one make."""
    high = float(streams("voltage").choice(VOLTAGES))
    lags = streams("lags")
    amplifier = _log_uniform(lags, *AMPLIFIER)
    lag = _log_uniform(lags, *LAG) if lags.uniform() < LAGS else np.inf
    slew = high * _log_uniform(streams("slew"), 500.0, 5_000.0)
    first, second, third = (
        Stack(
            (0.0, high),
            float(stroke),
            float(part("curvature").uniform(0.0, 0.3 * (CHANGE[1] - change) / 4)),
            amplifier,
            lag,
            slew,
            _hysteresis(part("hysteresis"), family, change * part("loop").uniform(0.9, 1.0)),
            _creep(part("creep"), creep),
        )
        for stroke, part in zip(strokes, map(streams.within, "xyz"), strict=True)
    )
    return first, second, third


def _hysteresis(rng: np.random.Generator, family: str, change: float) -> Hysteresis:
    if family == "bouc-wen":
        return stack_hysteresis.bouc_wen(change, rng.uniform(0.5, 1.0), rng.uniform(0.1, 0.5), rng.uniform(1.0, 2.0))
    if family == "lugre-guide":
        return stack_hysteresis.straight()
    count = int(rng.integers(4, 41))
    threshold = np.sort(rng.uniform(0.005, 0.45, count))
    density = rng.uniform(0.2, 1.0, count) * np.exp(-rng.uniform(0.0, 4.0) * threshold)
    if family == "prandtl-ishlinskii":
        return stack_hysteresis.prandtl_ishlinskii(change, threshold, density)
    return stack_hysteresis.maxwell_slip(change, threshold, density, _log_uniform(rng, 5e-5, 5e-4))


def _creep(rng: np.random.Generator, kind: str) -> Creep:
    if kind == "logarithmic":
        return creeping.logarithmic(rng.uniform(0.005, 0.03), _log_uniform(rng, 1e-3, 0.1))
    if kind == "power law":
        return creeping.power_law(rng.uniform(0.005, 0.03), rng.uniform(0.05, 0.3))
    count = int(rng.integers(1, 5))
    times = np.sort(0.05 * 2_000.0 ** rng.uniform(size=count))
    return creeping.chain(times.tolist(), (rng.uniform(0.02, 0.1, count) / count).tolist())


def _guides(streams: Streams, change: float, modes: Modes, travel: float) -> tuple[Guide, ...]:
    """Draw what rubs on each plate: it may stick over a part of its travel."""
    made = []
    for axis in range(3):
        rng = streams.within("xyz"[axis])("guide")
        softest = np.sum((modes.plate[axis] / (2 * np.pi * modes.frequency)) ** 2)
        bristle = 2.0 * change / (1.0 - change) / softest
        coulomb = travel / softest * _log_uniform(rng, 0.005, 0.04)
        mass = 1.0 / softest / (2 * np.pi * modes.frequency.min()) ** 2
        damper = 2.0 * np.sqrt(bristle * mass)
        made.append(
            Guide(
                bristle,
                rng.uniform(0.02, 0.3) * damper,
                rng.uniform(0.0, 0.02) * damper,
                coulomb,
                coulomb * rng.uniform(1.05, 1.6),
                _log_uniform(rng, 2e-4, 5e-3),
            )
        )
    return tuple(made)


def _sensors(
    streams: Streams, travel: float, stacks: tuple[Stack, ...], modes: Modes
) -> tuple[Sensor, Sensor, Sensor, float]:
    """Draw gauge, capacitive sensor and laser, and the laser's own rate."""
    gauge, plate, laser = (streams.within(name) for name in ("gauge", "capacitive", "laser"))
    span = max(stack.stroke for stack in stacks) * float(np.max(np.diag(modes.gains()[0])))

    def corner(part: Streams) -> float:
        rng = part("filter")
        return _log_uniform(rng, *FILTER) if rng.uniform() < FILTERS else float(np.inf)

    def gain(part: Streams, spread: float) -> np.ndarray:
        return np.asarray(1.0 + spread * np.clip(part("gain").standard_normal(3), -2, 2))

    ranged = [
        Sensor(size * _log_uniform(part("noise"), *noise), 2.0 * size / 65_536, (-0.4 * size, 1.6 * size),
               gain(part, spread), corner(part))
        for part, size, noise, spread in ((gauge, span, GAUGE_NOISE, 0.01), (plate, travel, PLATE_NOISE, 0.002))
    ]  # fmt: skip
    step = _log_uniform(laser("step"), *LASER_STEP)
    noise = max(_log_uniform(laser("noise"), *LASER_NOISE), 0.5 * step)
    far = Sensor(noise, step, (-15e-3, 15e-3), gain(laser, 0.001), corner(laser))
    return ranged[0], ranged[1], far, float(laser("rate").choice(LASER_RATES))


def _late(streams: Streams) -> tuple[int, int]:
    """Draw by how many samples gauge and capacitive sensor, and the laser, are late."""
    near, far = streams("delay").integers(0, DELAY, 2)
    return int(near), int(near + far)
