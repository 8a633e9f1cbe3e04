"""Mains hum as a disturbance: tones in the silence before a shot, and the power that they may have in its lines."""

import numpy as np

MAINS = (50.0, 60.0)
"""Hz; of these two the one whose harmonics are louder in a silence is meant."""
ASTRAY = 2e-3
"""Part of a frequency by which mains may be off its name."""
TONE = 12.0
"""Times the power that noise alone gives the estimate of a tone: less is none.  Noise is above that once in 160,000."""


def hum_power(silence: np.ndarray, rate: float, frequency: np.ndarray, frames: int, noise: np.ndarray) -> np.ndarray:
    """Estimate how much mains hum the lines of a shot may hold, from the silence before it.

    Parameters
    ----------
    silence : array, shape (samples, outputs), m/s^2
    rate : float, samples/s
    frequency : array, shape (lines,), Hz
    frames : int, samples
        Of the shot whose lines are meant.
    noise : array, shape (lines, outputs), (m/s^2 s)^2
        E |N|^2 without hum, as of `disturbance.noise_power`.

    Returns
    -------
    array, shape (lines, outputs), (m/s^2 s)^2
        Largest |H|^2 of a tone anywhere within `ASTRAY` of each harmonic, with its leakage; 0 where no tone is heard.
    """
    length, found = frames / rate, [np.zeros(noise.shape)]
    for name in MAINS:
        tones = name * np.arange(1, int(frequency[-1] / name) + 1)
        if len(silence) < rate / name * 4:  # neighbouring tones cannot be told apart
            continue
        size = np.abs(_amplitudes(silence, tones / rate)) ** 2 * (length / 2) ** 2
        alone = np.column_stack([np.interp(tones, frequency, each) for each in noise.T]) * frames / len(silence)
        power = np.where(size > TONE * alone, size, 0.0)
        away = np.maximum(np.abs(frequency[:, None] - tones) - ASTRAY * tones, 0.0)
        found.append(_leaked(away * length) @ power)
    loudest = max(found, key=lambda each: float(each.sum()))
    return loudest


def _amplitudes(silence: np.ndarray, tones: np.ndarray) -> np.ndarray:
    """Fit tones, cycles a sample, with offset and slope; return their complex amplitudes (tones, outputs)."""
    samples = np.arange(len(silence)) - (len(silence) - 1) / 2
    turns = 2 * np.pi * tones * samples[:, None]
    columns = np.column_stack([np.ones(len(silence)), samples / len(silence), np.cos(turns), np.sin(turns)])
    fitted = np.linalg.lstsq(columns, silence, rcond=None)[0][2:]
    amplitudes: np.ndarray = fitted[: len(tones)] - 1j * fitted[len(tones) :]
    return amplitudes


def _leaked(lines: np.ndarray) -> np.ndarray:
    """Return the part of a tone's power that a line holds which is so many lines away: the envelope of a sinc^2."""
    part: np.ndarray = 1.0 / np.maximum(np.pi * lines, 1.0) ** 2
    return part
