"""Macro and micro manipulators drawn by seed: the arm of the macro manipulator is the family."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.manipulator_pair import Macro, ManipulatorPair, ManipulatorPairPlant, Micro
from firmware_sim.population.streams import Streams

KIND = "pair"
FAMILIES = ("lags", "oscillating", "flexible")
"""Real poles; a pair of complex ones among them; real ones and a mode beside them."""
ORDER = 1, 4
"""Of the arm, its mode not counted."""
SLOW, RATIO, FAST = (0.15, 2.0), (3.0, 30.0), (0.01, 0.3)
"""s of the arm's poles together; times as fast the micro manipulator's loop is; s of that."""
DEAD_TIME, PROMPT = 0.04, 0.25
"""s at most, and part of the pairs that have none."""
MODE, MODE_DAMPING, MODE_SHARE = (3.0, 15.0), (0.02, 0.15), (0.05, 0.5)
"""Hz, 1 and 1, of a flexible arm."""
CORNER = 2.0, 20.0
"""Hz, of guided motion's filter."""
SPEED = 5e-3, 0.1
"""m/s, fastest of the arm."""
TRAVEL, LEADS = (2e-3, 25e-3), (1.5e-3, 8e-3)
"""m to either side; m from a reference to the micro manipulator's place at which its control signal saturates."""
INNER = 2.0, 20.0
"""1/s."""
LAG = 0.05, 0.35
"""1: of the inner loop's time constant, its lag."""
RINGING, RINGING_DAMPING, RINGING_SHARE = (15.0, 80.0), (0.01, 0.1), (0.02, 0.3)
"""Hz, 1 and 1, of the micro manipulator's mode."""
GENTLE = 0.5
"""Of the gain at which the mode would ring by itself in the inner loop, at most."""
QUIET, NOISE = 0.15, (0.5e-6, 50e-6)
"""Part of the pairs that have no noise; m rms of the noisiest sensor."""
RATE = 250.0
"""samples/s, of mid-ranging."""


@dataclass(frozen=True)
class DrawnPair:
    """A pair, and what is measured on it.

    Parameters
    ----------
    plant : ManipulatorPair
    family : str
    travel : float, m, of the micro manipulator to either side of its middle
    fast, slow : float, s
        In which each comes to 63 % of a small step, dead time and all.
    """

    plant: ManipulatorPair
    family: str
    travel: float
    fast: float
    slow: float


def draw_pair(seed: int, family: str) -> DrawnPair:
    """Draw a pair.

    Parameters
    ----------
    seed : int
    family : str, of `FAMILIES`
    """
    streams = Streams(seed, KIND, family)
    slow = _log_uniform(streams("slow"), *SLOW)
    fast = float(np.clip(slow / _log_uniform(streams("ratio"), *RATIO), *FAST))
    travel = _log_uniform(streams("travel"), *TRAVEL)
    plant = ManipulatorPair(_macro(streams, family, slow), _micro(streams, fast, travel), _noise(streams), seed)
    return DrawnPair(plant, family, travel, *_measured(plant))


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(low * (high / low) ** rng.uniform())


def _macro(streams: Streams, family: str, time: float) -> Macro:
    least = 2 if family == "oscillating" else ORDER[0]
    order = int(streams("order").integers(least, ORDER[1] + 1))
    shares = np.sort(streams("poles").uniform(0.05, 1.0, order))[::-1]
    times = time * shares / shares.sum()
    poles = [complex(-1.0 / each) for each in times]
    if family == "oscillating":
        damping, omega = streams("damping").uniform(0.3, 0.9), 2.0 / (times[0] + times[1])
        pair = omega * (-damping + 1j * np.sqrt(1.0 - damping**2))
        poles[:2] = [pair, pair.conjugate()]
    late = streams("dead time")
    dead_time = 0.0 if late.uniform() < PROMPT else late.uniform(0.0, DEAD_TIME)
    mode = streams("mode")
    return Macro(
        dead_time=float(dead_time),
        corner=_log_uniform(streams("filter"), *CORNER),
        filters=int(streams("filters").integers(1, 3)),
        speed=_log_uniform(streams("speed"), *SPEED),
        poles=tuple(poles),
        mode=_log_uniform(mode, *MODE),
        damping=_log_uniform(mode, *MODE_DAMPING),
        share=float(mode.uniform(*MODE_SHARE)) if family == "flexible" else 0.0,
    )


def _micro(streams: Streams, time: float, travel: float) -> Micro:
    inner = _log_uniform(streams("inner"), *INNER)
    lag, mode = time * streams("lag").uniform(*LAG), streams("ringing")
    frequency, damping = _log_uniform(mode, *RINGING), _log_uniform(mode, *RINGING_DAMPING)
    omega = 2 * np.pi * frequency
    most = GENTLE * 2 * damping * time * omega * np.hypot(1.0, omega * lag)
    return Micro(
        inner_gain=inner,
        limit=inner * _log_uniform(streams("lead"), *LEADS),
        process_gain=1.0 / (time * inner),
        lag=float(lag),
        mode=frequency,
        damping=damping,
        share=float(min(mode.uniform(*RINGING_SHARE), most)),
        stop=1.2 * travel,
    )


def _noise(streams: Streams) -> tuple[float, float, float]:
    rng = streams("noise")
    size = 0.0 if rng.uniform() < QUIET else _log_uniform(rng, *NOISE)
    first, second, third = size * np.array([1.0, rng.uniform(0.1, 1.0), rng.uniform(0.3, 1.0)])
    return float(first), float(second), float(third)


def _measured(pair: ManipulatorPair) -> tuple[float, float]:
    """Return in what time, s, each manipulator comes to 63 % of a step too small to meet a limit."""
    macro = pair.macro
    late = (
        sum(1.0 / abs(pole.real) for pole in macro.poles) + macro.dead_time + macro.filters / (2 * np.pi * macro.corner)
    )
    samples = round(RATE * (1.5 * late + 0.2))
    still = ManipulatorPair(pair.macro, pair.micro, (0.0, 0.0, 0.0), pair.seed)
    step, found = np.full((samples, 1), 1e-6), [np.zeros((samples, 1)) for _ in range(5)]
    ManipulatorPairPlant(RATE, still).run(step, step, *found)
    there = [np.flatnonzero(each[:, 0] >= (1 - np.exp(-1.0)) * 1e-6)[0] for each in found[1:3]]
    return float(there[0] + 1) / RATE, float(there[1] + 1) / RATE
