"""Drives that people identify with: multisines, sweeps at three levels, noise, all of one energy."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, chirp, sosfilt

PERIOD, PAUSE, EDGE = 5.0, 0.5, 0.05
"""s: of a multisine; between sweeps; of a fade."""
LEVELS = (0.5, 1.0, 2.0)
"""1, of sweeps."""


@dataclass(frozen=True)
class Asked:
    """What a drive is for.

    Parameters
    ----------
    coils : int
    rate : float, samples/s
    seconds : float, s
    band : (float, float), Hz
    seed : int
    """

    coils: int
    rate: float
    seconds: float
    band: tuple[float, float]
    seed: int


def drive_of(kind: str, asked: Asked, energy: float) -> np.ndarray:
    """Return a drive of a kind, (samples, coils), V, of so much energy, V^2 s."""
    drive = {"multisine": _multisines, "sweeps": _sweeps, "noise": _noise}[kind](asked)
    scaled: np.ndarray = drive * np.sqrt(energy * asked.rate / (drive**2).sum())
    return scaled


def _multisines(asked: Asked) -> np.ndarray:
    """Return as many multisines as there are coils, each repeated."""
    rng, samples = np.random.default_rng(asked.seed), round(PERIOD * asked.rate)
    lines = np.arange(int(asked.band[0] * PERIOD) - 20, int(asked.band[1] * PERIOD) + 21)
    parts = []
    for _ in range(asked.coils):
        spectrum = np.zeros((samples // 2 + 1, asked.coils), complex)
        spectrum[lines] = np.exp(2j * np.pi * rng.random((len(lines), asked.coils)))
        repeated = max(round(asked.seconds / PERIOD / asked.coils), 2)
        parts.append(np.tile(np.fft.irfft(spectrum, samples, axis=0), (repeated, 1)))
    return np.concatenate(parts)


def _sweeps(asked: Asked) -> np.ndarray:
    """Return sweeps of coil after coil, of each level after level."""
    length = asked.seconds / (asked.coils * len(LEVELS)) - PAUSE
    time = np.arange(round(length * asked.rate)) / asked.rate
    one = _faded(chirp(time, asked.band[0] - 4, length, asked.band[1] + 10)[:, None], asked.rate)
    silence = np.zeros((round(PAUSE * asked.rate), asked.coils))
    places = [(coil, level) for coil in range(asked.coils) for level in LEVELS]
    sweeps = (level * one * (np.arange(asked.coils) == coil) for coil, level in places)
    return np.concatenate([part for sweep in sweeps for part in (sweep, silence)])


def _noise(asked: Asked) -> np.ndarray:
    """Return independent noise on all coils."""
    white = np.random.default_rng(asked.seed).standard_normal((round(asked.seconds * asked.rate), asked.coils))
    wide = butter(4, [asked.band[0] - 4, asked.band[1] + 20], "bandpass", fs=asked.rate, output="sos")
    return _faded(sosfilt(wide, white, axis=0), asked.rate)


def _faded(drive: np.ndarray, rate: float) -> np.ndarray:
    edge = round(EDGE * rate)
    window = np.ones(len(drive))
    window[:edge] = 0.5 - 0.5 * np.cos(np.pi * np.arange(edge) / edge)
    window[len(window) - edge :] = window[:edge][::-1]
    faded: np.ndarray = drive * window[:, None]
    return faded
