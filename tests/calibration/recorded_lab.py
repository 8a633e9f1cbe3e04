"""Recordings of a linear vibrator whose transfer matrix is known, as another program makes them."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from scipy.signal import butter, chirp, sosfilt

from calibration.recorded_signals import Recorded
from firmware_sim.plants.vibrator import VibratorPlant
from rigkit.foreign_stream import Signals
from tests.vibractl.linear_rig import QUIET, RATE, linear_matrix

BAND = ("characterisation.band=[30, 130]",)
"""Of most tests: a few lines are as good as many."""


def noise(seed: int, seconds: float = 5.0, first: float = 25.0, last: float = 150.0) -> np.ndarray:
    """Return noise of one band on both drives, 1 V rms."""
    band = butter(4, [first, last], "bandpass", fs=RATE, output="sos")
    drive = sosfilt(band, np.random.default_rng(seed).standard_normal((round(seconds * RATE), 2)), axis=0)
    return faded(drive) / drive.std()


def sweep(first: float = 25.0, last: float = 150.0, seconds: float = 5.0) -> np.ndarray:
    """Return a sweep (samples,), V."""
    time = np.arange(round(seconds * RATE)) / RATE
    return np.asarray(faded(chirp(time, first, seconds, last)[:, None])[:, 0])


def multisine(seed: int, period: float = 2.0, periods: int = 4, step: int = 1) -> np.ndarray:
    """Return periods of a multisine on both drives, 1 V rms, of every `step`-th line from 25 to 150 Hz."""
    rng, samples = np.random.default_rng(seed), round(period * RATE)
    lines = np.arange(round(25 * period) | 1, round(150 * period), step)
    spectrum = np.zeros((samples // 2 + 1, 2), complex)
    spectrum[lines] = np.exp(2j * np.pi * rng.random((len(lines), 2)))
    drive = np.fft.irfft(spectrum, samples, axis=0)
    return np.tile(drive / drive.std(), (periods, 1))


def faded(drive: np.ndarray) -> np.ndarray:
    """Return a drive (samples, drives) with edges of 50 ms."""
    edge = round(0.05 * RATE)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.arange(edge) / edge)
    window = np.ones(len(drive))
    window[:edge], window[-edge:] = rise, rise[::-1]
    return drive * window[:, None]


def alone(signal: np.ndarray, side: int) -> np.ndarray:
    """Return a drive of one side, the other at rest."""
    drive = np.zeros((len(signal), 2))
    drive[:, side] = signal
    return drive


def heard(drive: np.ndarray, level: float = 0.3, seed: int = 1, **options: float) -> np.ndarray:
    """Return the responses to a drive, m/s^2, with white noise of that level."""
    played = np.ascontiguousarray(drive)
    clean = _heard(played.tobytes(), tuple(options.items()))
    return clean + level * np.random.default_rng(10_000 + seed).standard_normal(clean.shape)


@cache
def _heard(drive: bytes, options: tuple[tuple[str, float], ...]) -> np.ndarray:
    played = np.frombuffer(drive).reshape(-1, 2).copy()
    response = np.zeros_like(played)
    VibratorPlant(RATE, **{**QUIET, **dict(options)}).run(played, response)
    return response


def recorded(drive: np.ndarray, response: np.ndarray, name: str = "a.wav", full_scale: float = np.inf) -> Recorded:
    """Return a recording that is not in a file."""
    return Recorded(signals(drive, f"drive-{name}", "V"), signals(response, name, "m/s^2"), full_scale)


def signals(data: np.ndarray, name: str, unit: str = "1") -> Signals:
    """Return signals that are not in a file."""
    width = data.shape[1]
    names = tuple(f"channel_{number + 1}" for number in range(width))
    return Signals(
        Path(name), names, (unit,) * width, float(RATE), len(data), lambda: iter([data]), tuple(range(width))
    )


def records(drives: Sequence[np.ndarray], level: float = 0.3) -> list[Recorded]:
    """Return the recordings of some drives."""
    return [recorded(drive, heard(drive, level, n), f"{n}.wav") for n, drive in enumerate(drives)]


@cache
def _truth(frequency: bytes) -> np.ndarray:
    return linear_matrix().at(np.frombuffer(frequency)).response


def truth(frequency: np.ndarray) -> np.ndarray:
    """Return the transfer matrix, (lines, 2, 2), m/s^2 per V."""
    return _truth(frequency.tobytes())
