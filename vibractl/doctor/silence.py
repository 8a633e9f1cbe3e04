"""What a recording without a drive says: mains hum and noise, as lines of a shot, against the reference."""

from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len
from scipy.signal import welch
from scipy.signal.windows import blackmanharris

from vibractl.config import RigConfig
from vibractl.decibels import FAINT, decibels
from vibractl.learning.laws import SIGNIFICANT
from vibractl.setup import reference_of

MAINS = (50.0, 60.0)
"""Hz."""
MAINS_TOLERANCE = 0.005
"""Relative deviation of the mains' frequency."""
PADDING = 4
"""Times the recording's length that its spectrum is computed over: less than 0.1 dB is lost between lines."""
OCTAVES = 31.25 * 2.0 ** np.arange(0, 9)
"""Hz, middles."""
BESIDE_HUM = 3.0
"""Hz about a mains harmonic that count as hum and not as noise."""


@dataclass(frozen=True)
class Level:
    """The reference as noise is compared with it.

    Parameters
    ----------
    line : float, m/s^2 s
        RMS of its significant lines; of the weakest side.
    seconds : float, s
        Its length: noise of density S gives a line of sqrt(S seconds), a tone of amplitude A one of A seconds / 2.
    """

    line: float
    seconds: float


def reference_level(config: RigConfig) -> Level:
    """Return the level of the rig file's reference.

    Raises
    ------
    ValueError : the reference cannot be made.
    """
    made = reference_of(config)
    size = np.abs(np.fft.rfft(made.signal, axis=0)) / config.audio.rate
    strong = size > SIGNIFICANT * size.max(axis=0)
    level = np.sqrt((size**2 * strong).sum(axis=0) / strong.sum(axis=0))
    return Level(float(level.min()), len(made.signal) / config.audio.rate)


@dataclass(frozen=True)
class Hum:
    """Mains hum of the loudest accelerometer.

    Parameters
    ----------
    mains : float, Hz, 50 or 60
    frequency : array, shape (harmonics,), Hz
    level : array, shape (harmonics,), dB
        A line of a shot re the reference's.
    response : array, shape (harmonics,), int
        On which accelerometer, counted from 1.
    """

    mains: float
    frequency: np.ndarray
    level: np.ndarray
    response: np.ndarray


def hum(silence: np.ndarray, rate: float, reference: Level, highest: float) -> Hum:
    """Measure the harmonics of the mains, of 50 or of 60 Hz, whichever is the stronger.

    Parameters
    ----------
    silence : array, shape (samples, responses), m/s^2
    rate : float, samples/s
    reference : Level
    highest : float, Hz

    Returns
    -------
    Hum
    """
    window = blackmanharris(len(silence), sym=False)[:, None]
    points = next_fast_len(PADDING * len(silence), real=True)
    amplitude = np.abs(np.fft.rfft(window * (silence - silence.mean(axis=0)), points, axis=0)) * 2 / window.sum()
    frequency = np.fft.rfftfreq(points, 1 / rate)
    found = []
    for mains in MAINS:
        places = mains * np.arange(1, int(highest / mains) + 1)
        spans = [np.abs(frequency - place) <= max(MAINS_TOLERANCE * place, 4 * frequency[1]) for place in places]
        peaks = np.array([amplitude[span].max(axis=0) for span in spans])
        level = decibels(np.maximum(peaks.max(axis=1) * reference.seconds / 2 / reference.line, FAINT))
        found.append(Hum(mains, places, level, peaks.argmax(axis=1) + 1))
    return max(found, key=lambda each: float(np.sum(10 ** (each.level / 10))))


def noise(
    silence: np.ndarray, rate: float, reference: Level, band: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Measure the noise of each octave, hum left out, as a shot's lines re the reference's.

    Parameters
    ----------
    silence : array, shape (samples, responses), m/s^2
    rate : float, samples/s
    reference : Level
    band : (float, float), Hz

    Returns
    -------
    middle : array, shape (octaves,), Hz
        Those of `OCTAVES` that lie at least in part within the band.
    level : array, shape (octaves, responses), dB
        RMS over the octave's lines within the band.
    """
    frequency, density = line_density(silence, rate)
    for mains in MAINS:
        apart = np.abs(frequency - mains * np.round(frequency / mains))
        density[(apart < BESIDE_HUM) & (frequency > mains / 2)] = np.nan
    middles, levels = [], []
    for middle in OCTAVES:
        low, high = max(middle / np.sqrt(2), band[0]), min(middle * np.sqrt(2), band[1])
        inside = density[(frequency >= low) & (frequency <= high)]
        if len(inside) and np.isfinite(inside).any():
            middles.append(middle)
            levels.append(np.sqrt(np.nanmean(inside, axis=0) * reference.seconds) / reference.line)
    return np.array(middles), decibels(np.maximum(np.array(levels), FAINT))


def line_density(silence: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the two-sided power density of a recording, from Welch's method with a second's window.

    Parameters
    ----------
    silence : array, shape (samples, responses), m/s^2
    rate : float, samples/s

    Returns
    -------
    frequency : array, shape (bins,), Hz
    density : array, shape (bins, responses), (m/s^2)^2 s
    """
    frequency, density = welch(silence, rate, "hann", nperseg=min(round(rate), len(silence)), axis=0)
    return frequency, density / 2
