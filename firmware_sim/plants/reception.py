"""What is between a vibrator's motion and its recording: delays, sensors, and what they pick up beside it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.pickup import Mains, Noise, Pickup, Ships
from firmware_sim.plants.sensing_kernel import interpolator, resonance, run_sensors

BLOCK = 4096
"""Samples between two steps of what wanders."""


def in_blocks(done: int, frames: int) -> Iterator[tuple[slice, bool]]:
    """Cut the next `frames` samples, after `done`, where blocks end; say of each part whether a block begins there."""
    start = 0
    while start < frames:
        into = (done + start) % BLOCK
        end = min(frames, start + BLOCK - into)
        yield slice(start, end), into == 0
        start = end


@dataclass(frozen=True)
class Sensors:
    """The sensors themselves.

    Parameters
    ----------
    delay : array, shape (sensors,), s
    resonance, damping : arrays, shape (sensors,), Hz and 1
        A sensor's own; 0 Hz for none.
    bend : array, shape (sensors, 2)
        What is added per square and per cube of what it hears, 1/(m/s^2) and 1/(m/s^2)^2.
    """

    delay: np.ndarray
    resonance: np.ndarray
    damping: np.ndarray
    bend: np.ndarray

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Return what they make of a small acceleration, shape (bins, sensors), 1.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        """
        delayed = np.exp(-2j * np.pi * frequency[:, None] * self.delay)
        ratio = frequency[:, None] / np.where(self.resonance > 0, self.resonance, np.inf)
        through: np.ndarray = delayed / (1 - ratio**2 + 2j * self.damping * ratio)
        return through


@dataclass(frozen=True)
class Reception:
    """Sensors, and what they pick up.

    Parameters
    ----------
    sensors : Sensors
    mains : Mains
    noise : Noise
    ships : Ships
    """

    sensors: Sensors
    mains: Mains
    noise: Noise
    ships: Ships


def silent_reception(sensors: Sensors) -> Reception:
    """Return sensors that pick up nothing."""
    count = len(sensors.delay)
    quiet, none = np.zeros(count), np.zeros((0, count))
    ships = Ships(0.0, 0.0, 1.0, 100.0, 1.0, 0.0, quiet)
    return Reception(sensors, Mains(50.0, 0.0, none, none), Noise(quiet, quiet, 0.0), ships)


class Receiver:
    """A `Reception`, sample by sample.

    Parameters
    ----------
    reception : Reception
    rate : float, samples/s
    seed : int
        Of noise and of what wanders.
    """

    def __init__(self, reception: Reception, rate: float, seed: int) -> None:
        sensors = reception.sensors
        self._bend = sensors.bend
        self._pickup = Pickup(reception.mains, reception.noise, reception.ships, rate, BLOCK, seed)
        pairs = [interpolator(delay * rate) for delay in sensors.delay]
        longest = max(len(taps) for _, taps in pairs)
        self._whole = np.array([whole for whole, _ in pairs])
        self._taps = np.zeros((len(pairs), longest))
        for row, (_, taps) in zip(self._taps, pairs, strict=True):
            row[: len(taps)] = taps
        length = 1 << int(self._whole.max() + longest).bit_length()
        self._past, self._place = np.zeros((len(pairs), length)), 0
        each = zip(sensors.resonance, sensors.damping, strict=True)
        self._filters = np.array([resonance(frequency, damping, rate) for frequency, damping in each])
        self._memory = np.zeros((len(pairs), 2))

    def begin_block(self) -> None:
        """Let what wanders take a step: before each `BLOCK` samples."""
        self._pickup.begin_block()

    def hear(self, heard: np.ndarray) -> None:
        """Turn accelerations, shape (frames, sensors) m/s^2, into what is recorded, in place, within a block."""
        self._place = run_sensors(
            heard, self._past, self._place, self._whole, self._taps, self._filters, self._memory, self._bend
        )
        self._pickup.add(heard)
