"""Round-trip delay to a fraction of a sample, from a short chirp that was emitted and recorded."""

import math
from typing import NamedTuple

import numpy as np

from rigkit.fade import rise

LOOPBACK_BAND = (1000.0, 8000.0)
MARKER_BAND = (1000.0, 4000.0)
_SECONDS = 0.0232
"""Wanted length of a timing signal; the nearest power of two in samples is taken, for fast transforms."""
_EDGE = 0.15
"""Part of the timing signal that is tapered, at each end."""


class Delay(NamedTuple):
    """How late a recording is, and whether to believe it.

    Parameters
    ----------
    samples : float, samples
        NaN when the recording is silent or not finite.
    quality : float, 1
        Normalised correlation at that delay, from 1 (the same signal) down to 0 and below (inverted): the square is
        the part of the recorded energy that is the emitted signal.  Only energy above half the lower edge of the band
        counts: hum, and what a vibrator does in its own band, say nothing about time.
    """

    samples: float
    quality: float


def timing_signal(rate: float, band: tuple[float, float], amplitude: float) -> np.ndarray:
    """Make a short chirp with raised-cosine edges, about 20 ms long.

    Parameters
    ----------
    rate : float, samples/s
    band : (float, float), Hz
        Instantaneous frequency at both ends, rising, below half the rate.
    amplitude : float, in the unit of the channel it is for

    Returns
    -------
    array, shape (samples,)
        A power of two samples: 1024 at 44.1 and 48 kHz.

    Raises
    ------
    ValueError : the band does not rise or does not fit the rate.
    """
    low, high = band
    if not 0 < low < high < rate / 2:
        raise ValueError(f"the timing band is {low:g} to {high:g} Hz, must rise within 0 to {rate / 2:g} Hz")
    length = 2 ** round(math.log2(_SECONDS * rate))
    time = np.arange(length) / rate
    chirp = np.sin(2 * np.pi * (low * time + (high - low) / (2 * length / rate) * time**2))
    edge = max(1, round(_EDGE * length))
    chirp[:edge] *= rise(edge)
    chirp[-edge:] *= rise(edge)[::-1]
    return np.asarray(amplitude * chirp)


def timing_train(chirp: np.ndarray, count: int) -> np.ndarray:
    """Repeat a chirp without a gap, each time with a sign from a fixed pseudo-random sequence.

    The signs tell one repetition from the next, so that a slip by whole chirps does not pass unseen.

    Parameters
    ----------
    chirp : array, shape (length,), any unit
    count : int, >= 1

    Returns
    -------
    array, shape (count * length,)
    """
    return np.outer(_signs(count), chirp).ravel()


def delay(emitted: np.ndarray, recorded: np.ndarray, rate: float, band: tuple[float, float]) -> Delay:
    """Find where in a recording the emitted timing signal lies.

    The whole samples come from the cross-correlation, the fraction from the phase slope of the cross-spectrum.

    Parameters
    ----------
    emitted : array, shape (length,), any unit
    recorded : array, shape (at least length,), any unit
        Searched from delay 0 to its length less that of `emitted`.
    rate : float, samples/s
    band : (float, float), Hz
        Where the emitted signal has its energy.

    Returns
    -------
    Delay

    Raises
    ------
    ValueError : the recording is shorter than the signal.
    """
    length, lags = len(emitted), len(recorded) - len(emitted) + 1
    if lags < 1:
        raise ValueError(
            f"the recording is {len(recorded)} samples long, must be >= {length}, the timing signal's length"
        )
    if not np.all(np.isfinite(recorded)):
        return Delay(math.nan, 0.0)
    points = 2 ** math.ceil(math.log2(len(recorded) + length))
    correlation = np.fft.irfft(np.fft.rfft(recorded, points) * np.conj(np.fft.rfft(emitted, points)), points)[:lags]
    whole = int(np.argmax(correlation))
    fraction, quality = deviations(emitted, recorded[None, whole : whole + length], rate, band)
    return Delay(whole + float(fraction[0]), float(quality[0]))


def train_deviations(
    chirp: np.ndarray, recorded: np.ndarray, whole: int, rate: float, band: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Compare every chirp of a recorded `timing_train` with where a delay of `whole` samples puts it.

    Parameters
    ----------
    chirp : array, shape (length,), any unit
    recorded : array, shape (samples,), from the train's first emitted sample on
    whole : int, samples, >= 0
    rate : float, samples/s
    band : (float, float), Hz

    Returns
    -------
    deviation : array, shape (chirps,), samples
        Delay of each chirp less `whole`; see `deviations`.
    quality : array, shape (chirps,), 1
    """
    count = (len(recorded) - whole) // len(chirp)
    rows = recorded[whole : whole + count * len(chirp)].reshape(count, len(chirp))
    return deviations(chirp, _signs(count)[:, None] * rows, rate, band)


def deviations(
    emitted: np.ndarray, recorded: np.ndarray, rate: float, band: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Measure small delays, of a sample or so, of many recordings of one signal.

    Weighted least squares of a line through the origin on the phase of the cross-spectrum, over the band.

    Parameters
    ----------
    emitted : array, shape (length,), any unit
    recorded : array, shape (recordings, length), any unit
    rate : float, samples/s
    band : (float, float), Hz

    Returns
    -------
    deviation : array, shape (recordings,), samples
        NaN for a silent recording or one that is not finite.
    quality : array, shape (recordings,), 1
        As in `Delay`.
    """
    usable = np.isfinite(recorded).all(axis=1) & recorded.any(axis=1)
    omega = 2 * np.pi * np.fft.rfftfreq(len(emitted))  # rad a sample
    counted = (omega >= np.pi * band[0] / rate) & (omega < np.pi)
    omega = omega[counted]
    sent = np.fft.rfft(emitted)[counted]
    heard = np.fft.rfft(np.where(usable[:, None], recorded, 0.0))[:, counted]
    cross = heard * np.conj(sent)
    weight = np.abs(cross) * ((omega >= 2 * np.pi * band[0] / rate) & (omega <= 2 * np.pi * band[1] / rate))
    with np.errstate(invalid="ignore", divide="ignore"):
        deviation = -np.sum(weight * omega * np.angle(cross), axis=1) / np.sum(weight * omega**2, axis=1)
        straight = np.sum(np.real(cross * np.exp(1j * deviation[:, None] * omega)), axis=1)
        quality = straight / np.sqrt(np.sum(np.abs(heard) ** 2, axis=1) * np.sum(np.abs(sent) ** 2))
    return np.where(usable, deviation, np.nan), np.where(usable, quality, 0.0)


def _signs(count: int) -> np.ndarray:
    return np.where(np.random.default_rng(0).random(count) < 0.5, -1.0, 1.0)
