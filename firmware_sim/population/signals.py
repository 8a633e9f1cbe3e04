"""Records for identification: random systems, alone and in loops, with foreign noise and what spoils a record."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from firmware_sim.plants.linear_system import LinearSystem
from firmware_sim.population.draw import Quantity
from firmware_sim.population.excitations import EXCITATIONS, Damage
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams
from firmware_sim.population.systems import SYSTEMS, Matrices, with_integrators, with_unstable

ORDER, MOST_PORTS = (1, 40), 4
RATES = (1.0, 10.0, 100.0, 1_000.0, 10_000.0)
"""samples/s."""
SAMPLES = (500, 20_000)
NOISE = (0.0, 60.0)
"""dB: the output without noise over the noise."""
FOREIGN = (1, 6)
"""Poles of the noise of each output, which are none of the system's."""
LATE = 20
"""Samples, the longest dead time of an input; in a loop a quarter of it."""
LATE_ONES, LOOPS, INTEGRATING, UNSTABLE, SPOILED = 0.3, 0.3, 0.2, 0.15, 0.3
"""1: parts of the records with dead time, in a loop, with integrators, unstable, and of those with each damage."""
EFFORT, TRUST = (0.1, 100.0), (0.01, 10.0)
"""Of a loop: the weight of its input, and the noise that its filter expects."""


@dataclass(frozen=True)
class Record:
    """Signals and the truth behind them.

    Parameters
    ----------
    family : str
    given : array, shape (samples, inputs), 1
        NaN where samples are missing.
    measured : array, shape (samples, outputs), 1
    noise : array, shape (samples, outputs), 1
        What came to the output, as it was.
    truth : LinearSystem
    mixed : tuple of str
        What is in it beside a system and noise.
    gaps : list of (int, int)
        First sample and the one after the last.
    """

    family: str
    given: np.ndarray
    measured: np.ndarray
    noise: np.ndarray
    truth: LinearSystem
    mixed: tuple[str, ...]
    gaps: list[tuple[int, int]]


@dataclass(frozen=True)
class SignalSource:
    """A system and how it is recorded, as its seed has them.

    Parameters
    ----------
    family : str
    streams : Streams
    truth : LinearSystem
    excitation : str
    clear : float, dB
        The output without noise over the noise.
    in_loop : bool
    damage : Damage
    mixed : tuple of str
    samples : int
    quantities : tuple of Quantity
    """

    family: str
    streams: Streams
    truth: LinearSystem
    excitation: str
    clear: float
    in_loop: bool
    damage: Damage
    mixed: tuple[str, ...]
    samples: int
    quantities: tuple[Quantity, ...]

    def record(self, samples: int = 0) -> Record:
        """Record it; `samples` of the signals, its own number where that is 0."""
        count = samples or self.samples
        outputs, inputs = self.truth.direct.shape
        added = EXCITATIONS[self.excitation](self.streams("excitation"), count, inputs)
        loop = _loop(self.streams, self.truth) if self.in_loop else None
        silence = np.zeros((count, outputs))
        _, clean = self.truth.run(added, silence, loop)
        noise = foreign_noise(self.streams, count, outputs) * clean.std(axis=0) * 10 ** (-self.clear / 20)
        given, measured = self.truth.run(added, noise, loop)
        gaps = self.damage.done(self.streams, given, measured)
        return Record(self.family, given, measured, noise, self.truth, self.mixed, gaps)


def signal(family: str, seed: int) -> SignalSource:
    """Draw a system, how it is excited and what spoils the record.

    Parameters
    ----------
    family : str
        One of `SYSTEMS`: the kind of structure.
    seed : int, >= 0
    """
    streams = Streams(seed, "signal", family)
    rng = streams("order")
    order = int(np.rint(log_uniform(rng, *ORDER)))
    inputs, outputs = (int(streams(name).integers(1, MOST_PORTS + 1)) for name in ("inputs", "outputs"))
    system = SYSTEMS[family](streams, order, inputs, outputs)
    system, special = _special(streams, system)
    in_loop = bool(special) or bool(streams("loop").uniform() < LOOPS)
    if in_loop:
        system = *system[:3], 0 * system[3]  # without a direct term no loop is algebraic
    delay = _delay(streams, inputs, in_loop)
    truth = LinearSystem(*system, delay, float(streams("rate").choice(RATES)))
    damage, spoiled = _damage(streams)
    excitation = list(EXCITATIONS)[streams("kind of excitation").integers(len(EXCITATIONS))]
    clear = float(streams("noise level").uniform(*NOISE))
    mixed = (*special, *(["dead time"] if delay.any() else []), *(["closed loop"] if in_loop else []), *spoiled)
    samples = int(log_uniform(streams("samples"), *SAMPLES))
    said = (
        *(Quantity("order", len(truth.dynamics)), Quantity("inputs", inputs), Quantity("outputs", outputs)),
        Quantity("rate", truth.rate, "samples/s"),
        Quantity("samples", samples),
        Quantity("excitation", excitation),
        Quantity("output over noise", clear, "dB"),
        Quantity("dead time", tuple(int(late) for late in delay), "samples"),
        Quantity("largest pole", float(np.abs(truth.poles).max()), "1"),
        Quantity("mixed in", mixed or "nothing"),
    )
    return SignalSource(family, streams, truth, excitation, clear, in_loop, damage, mixed, samples, said)


def foreign_noise(streams: Streams, samples: int, outputs: int) -> np.ndarray:
    """Return coloured noise, shape (samples, outputs), 1 rms, each output's with poles and zeros of its own."""
    rng, source = streams("noise poles"), streams("noise")
    noise = source.standard_normal((samples, outputs))
    for column in noise.T:
        count = int(rng.integers(FOREIGN[0], FOREIGN[1] + 1))
        poles = [p for _ in range(count // 2) for p in _pair(rng, 0.97)] + [rng.uniform(-0.5, 0.97)] * (count % 2)
        zeros = [z for _ in range(count // 2) for z in _pair(rng, 0.9)] + [rng.uniform(-0.9, 0.9)] * (count % 2)
        column[:] = lfilter(np.poly(zeros).real, np.poly(poles).real, column)
        column /= column.std()
    return noise


def _pair(rng: np.random.Generator, farthest: float) -> tuple[complex, complex]:
    one = complex(rng.uniform(0.2, farthest) * np.exp(1j * rng.uniform(0, np.pi)))
    return one, one.conjugate()


def _special(streams: Streams, system: Matrices) -> tuple[Matrices, tuple[str, ...]]:
    """Put integrators or an unstable pole into a system that has room for them; either wants a loop."""
    rng = streams("special")
    kind, most = rng.uniform(), min(*system[3].shape, len(system[0]), 2)
    count = int(rng.integers(1, most + 1))
    if kind < INTEGRATING and len(system[0]) + count <= ORDER[1]:
        return with_integrators(system, count), ("integrators",)
    if INTEGRATING <= kind < INTEGRATING + UNSTABLE and len(system[0]) < ORDER[1]:
        return with_unstable(system, streams("unstable pole")), ("unstable pole",)
    return system, ()


def _delay(streams: Streams, inputs: int, in_loop: bool) -> np.ndarray:
    rng = streams("dead time")
    late, has_some = rng.integers(0, LATE + 1, inputs), rng.uniform() < LATE_ONES
    delay: np.ndarray = has_some * (late // 4 if in_loop else late)
    return delay


def _damage(streams: Streams) -> tuple[Damage, tuple[str, ...]]:
    """Draw what spoils the record, and name it."""
    rng = streams("damage")
    trend, spikes, bits, gaps = rng.uniform(size=4) < SPOILED
    sizes = streams("sizes of damage")
    damage = Damage(
        float(sizes.uniform(0.3, 3.0)) * bool(trend),
        float(log_uniform(sizes, 1e-4, 1e-2)) * bool(spikes),
        int(sizes.integers(5, 15)) * int(bits),
        int(sizes.integers(1, 6)) * int(gaps),
        bool(sizes.uniform() < 0.5),
    )
    named = {
        "trends": trend,
        "spikes": spikes,
        f"quantised to {damage.bits} bits": bits,
        "gaps held" if damage.kept else "gaps missing": gaps,
    }
    return damage, tuple(name for name, there in named.items() if there)


def _loop(streams: Streams, truth: LinearSystem) -> tuple[np.ndarray, np.ndarray]:
    rng = streams("loop's weights")
    try:
        return truth.loop(float(log_uniform(rng, *EFFORT)), float(log_uniform(rng, *TRUST)))
    except np.linalg.LinAlgError as fault:
        raise ValueError(f"no loop holds the system that this seed draws ({fault}); take another seed") from None
