"""What a system to be identified is excited with, and what becomes of a record on its way to a file."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams


def white(rng: np.random.Generator, samples: int, inputs: int) -> np.ndarray:
    """Return white noise, shape (samples, inputs), 1 rms."""
    drawn: np.ndarray = rng.standard_normal((samples, inputs))
    return drawn


def binary(rng: np.random.Generator, samples: int, inputs: int) -> np.ndarray:
    """Return noise of two levels that holds each for some samples, shape (samples, inputs), 1 rms."""
    held = int(rng.integers(1, 20))
    levels = rng.choice([-1.0, 1.0], (-(-samples // held), inputs))
    drawn: np.ndarray = np.repeat(levels, held, axis=0)[:samples]
    return drawn


def steps(rng: np.random.Generator, samples: int, inputs: int) -> np.ndarray:
    """Return a few steps at random times, shape (samples, inputs), of unit variance."""
    signal = np.zeros((samples, inputs))
    for column in signal.T:
        for start in rng.integers(0, samples, int(rng.integers(3, 20))):
            column[start:] = rng.standard_normal()
        column /= column.std()
    return signal


def sweep(rng: np.random.Generator, samples: int, inputs: int) -> np.ndarray:
    """Return sweeps from low to high, one input after the other, shape (samples, inputs), of amplitude sqrt(2)."""
    signal = np.zeros((samples, inputs))
    low, high = log_uniform(rng, 1e-3, 1e-2), rng.uniform(0.2, 0.48)
    for number, part in enumerate(np.array_split(np.arange(samples), inputs)):
        time = np.arange(len(part))
        signal[part, number] = np.sqrt(2) * np.sin(2 * np.pi * (low * time + (high - low) * time**2 / (2 * len(part))))
    return signal


def multisine(rng: np.random.Generator, samples: int, inputs: int) -> np.ndarray:
    """Return periods of a multisine of random phases, shape (samples, inputs), 1 rms."""
    period = min(samples, 2 ** int(rng.integers(7, 12)))
    lines = np.zeros((period // 2 + 1, inputs), complex)
    used = slice(1, int(rng.uniform(0.3, 1.0) * period / 2))
    lines[used] = np.exp(2j * np.pi * rng.uniform(size=lines[used].shape))
    one = np.fft.irfft(lines, period, axis=0)
    whole: np.ndarray = np.tile(one / one.std(axis=0), (-(-samples // period), 1))[:samples]
    return whole


EXCITATIONS: dict[str, Callable[[np.random.Generator, int, int], np.ndarray]] = {
    "white": white,
    "binary": binary,
    "steps": steps,
    "sweep": sweep,
    "multisine": multisine,
}


@dataclass(frozen=True)
class Damage:
    """What becomes of a record after it was measured; nothing where all is zero.

    Parameters
    ----------
    trend : float, 1
        Largest change of each output's mean over the record, in its standard deviations.
    spikes : float, 1
        Part of the samples that are far off.
    bits : int
        Of the converter, whose range the outputs just fill; 0 for as they are.
    gaps : int
        Stretches in which the logger stood still.
    kept : bool
        Whether it repeated the last sample meanwhile; else the samples are missing, which is NaN.
    """

    trend: float = 0.0
    spikes: float = 0.0
    bits: int = 0
    gaps: int = 0
    kept: bool = True

    def done(self, streams: Streams, given: np.ndarray, measured: np.ndarray) -> list[tuple[int, int]]:
        """Damage a record in place and return the gaps, first sample and the one after the last.

        Parameters
        ----------
        streams : Streams
        given : array, shape (samples, inputs), any unit
        measured : array, shape (samples, outputs), any unit
        """
        size = measured.std(axis=0) + 1e-300
        time = np.linspace(0, 1, len(measured))[:, None]
        rng = streams("trend's shape")
        slope, slow = rng.uniform(-1, 1, (2, measured.shape[1]))
        measured += self.trend * size * (rng.uniform(-1, 1, measured.shape[1]) + slope * time)
        measured += self.trend * size * 0.5 * slow * np.sin(2 * np.pi * rng.uniform(0.5, 3.0) * time)
        rng = streams("spikes' places")
        hit = rng.uniform(size=measured.shape) < self.spikes
        measured += hit * size * rng.choice([-1.0, 1.0], measured.shape) * rng.uniform(5, 50, measured.shape)
        if self.bits:
            step = np.ptp(measured, axis=0) / 2**self.bits + 1e-300
            measured[:] = step * np.round(measured / step)
        return self._gaps(streams("gaps' places"), given, measured)

    def _gaps(self, rng: np.random.Generator, given: np.ndarray, measured: np.ndarray) -> list[tuple[int, int]]:
        found = []
        for start in np.sort(rng.integers(1, len(measured), self.gaps)):
            end = min(int(start + max(1, rng.uniform(0.001, 0.02) * len(measured))), len(measured))
            for signal in (given, measured):
                signal[start:end] = signal[start - 1] if self.kept else np.nan
            found.append((int(start), end))
        return found
