"""What the records of a multisine say: the transfer matrix, its variance, and noise and distortion line by line."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from calibration.local_polynomial import local_polynomial
from calibration.multisine import Design

REACH, NARROW_REACH, DEGREE = 8, 4, 4
"""Excited lines to each side of a local polynomial, of one for narrow resonances and notches, and their degree."""
DOUBT_REACH = 1.0
"""Hz to each side of a line from where the largest variance is taken: what one window says of it is uncertain."""
FLOOR = 0.01
"""Relative to |G|, Frobenius: what no line shows alone.  Response depends on amplitude, smoothly over frequency; where
all else was certain (15 to 25 Hz), it was 0.011 between -30 dB and infinitely small on the simulated vibrator."""
LEVEL_REACH = 2.0
"""Hz to each side over which levels are averaged before they are shown."""


@dataclass(frozen=True)
class Spectra:
    """The lines of all records of a design, and of a silence.

    Parameters
    ----------
    drive : complex array, shape (records, bins, inputs), V
        Amplitudes: x(n) = Re X exp(j 2 pi f n / rate) at bins `first`, first + 1, ...
    response : complex array, shape (records, bins, outputs), m/s^2
    silence : complex array, shape (bins, outputs), m/s^2
    first : int
        Bin.
    """

    drive: np.ndarray
    response: np.ndarray
    silence: np.ndarray
    first: int


@dataclass(frozen=True)
class Levels:
    """What is in a record beside the linear response, rms amplitude of a line.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    response : array, shape (bins, outputs), m/s^2
        To the multisine.
    preload : array, shape (bins, outputs), m/s^2
        The same in every record: the preload's response and its own overtones; 0 where there is no preload.
    noise : array, shape (bins, outputs), m/s^2
        Heard in silence.
    even, odd : arrays, shape (bins, outputs), m/s^2
        Distortion and noise on even lines, and on odd lines that are not excited: what the multisine and the preload
        bring forth together.
    """

    frequency: np.ndarray
    response: np.ndarray
    preload: np.ndarray
    noise: np.ndarray
    even: np.ndarray
    odd: np.ndarray


def amplitudes(period: np.ndarray, first: int, last: int) -> np.ndarray:
    """Return the complex amplitudes of `period`, shape (samples, signals), at bins `first` to `last`."""
    lines: np.ndarray = np.fft.rfft(period, axis=0)[first : last + 1] * (2 / len(period))
    return lines


def frequency_of(design: Design, spectra: Spectra) -> np.ndarray:
    """Return the frequencies of the bins of spectra, (bins,), Hz."""
    frequency: np.ndarray = (spectra.first + np.arange(spectra.response.shape[1])) * design.rate / design.period
    return frequency


def raw_matrix(design: Design, spectra: Spectra) -> np.ndarray:
    """Read each excited line for each input: both sides' lines that carry the input's code, G = Y U^-1.

    Parameters
    ----------
    design : Design
    spectra : Spectra

    Returns
    -------
    complex array, shape (lines, outputs, inputs), m/s^2 per V

    Source
    ------
    Dobrowiecki, Schoukens and Guillaume 2006, IEEE Trans. Instrum. Meas. 55(6).
    """
    turn = np.exp(-2j * np.pi / design.records * np.arange(design.records)[:, None, None] * design.code)
    place = design.bins - spectra.first
    drive = np.einsum("rli,rlc->lic", spectra.drive[:, place], turn)
    response = np.einsum("rlo,rlc->loc", spectra.response[:, place], turn)
    matrix: np.ndarray = response @ np.linalg.inv(drive)
    return matrix


def matrix_on(design: Design, raw: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smooth raw lines over their neighbours and read them at the bins wanted.

    Where a wide polynomial misses what a narrow one shows, beyond the latter's variance, the narrow one is taken.

    Parameters
    ----------
    design : Design
    raw : complex array, shape (lines, outputs, inputs), m/s^2 per V
    wanted : int array, shape (wanted,)
        Bins.

    Returns
    -------
    response : complex array, shape (wanted, outputs, inputs), m/s^2 per V
    variance : array, the same shape, (m/s^2 per V)^2
        What the polynomials leave, the largest of the windows around, and a floor: noise, distortion, drift during a
        record and what bends faster than a polynomial are in it.
    """
    lines, at = design.bins.astype(float), wanted.astype(float)
    size = 2 * round(DOUBT_REACH * design.period / design.rate) + 1
    wide, narrow = (local_polynomial(lines, raw, at, reach, DEGREE) for reach in (REACH, NARROW_REACH))
    apart = uniform_filter1d(np.abs(wide.value - narrow.value) ** 2, size, axis=0, mode="nearest")
    bent = np.maximum(apart - uniform_filter1d(narrow.variance, size, axis=0, mode="nearest"), 0.0)
    wide_doubt, narrow_doubt = (
        maximum_filter1d(each.variance, size, axis=0, mode="nearest") for each in (wide, narrow)
    )
    value = np.where(wide_doubt + bent <= narrow_doubt, wide.value, narrow.value)
    doubt = np.minimum(wide_doubt + bent, narrow_doubt)
    floor = FLOOR**2 * (np.abs(value) ** 2).mean(axis=(1, 2), keepdims=True)
    return value, doubt + floor


def coherence_of(response: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Return which part of an element's estimated power is response.

    Parameters
    ----------
    response : complex array, shape (bins, outputs, inputs), any unit
    variance : array, shape (bins, outputs, inputs), the response's unit squared

    Returns
    -------
    array, shape (bins, outputs, inputs), 0 to 1
    """
    power = np.abs(response) ** 2
    part: np.ndarray = power / (power + variance)
    return part


def levels(design: Design, spectra: Spectra, detection: np.ndarray) -> Levels:
    """Sort what was recorded into response, preload, noise, and even and odd distortion.

    Parameters
    ----------
    design : Design
    spectra : Spectra
    detection : int array, shape (left out,)
        Odd bins that are not excited.

    Source
    ------
    Pintelon and Schoukens 2012, System Identification, sec. 4.3.
    """
    bins = spectra.first + np.arange(spectra.response.shape[1])
    reach = round(LEVEL_REACH * design.period / design.rate)
    mean = spectra.response.mean(axis=0)
    varying = np.sum(np.abs(spectra.response - mean) ** 2, axis=0) / (design.records - 1)
    found = [
        np.sqrt(_averaged(power, chosen, reach))
        for power, chosen in (
            (varying, np.isin(bins, design.bins)),
            (np.abs(mean) ** 2 * design.preload.any(), np.ones(len(bins), bool)),
            (np.abs(spectra.silence) ** 2, np.ones(len(bins), bool)),
            (varying, bins % 2 == 0),
            (varying, np.isin(bins, detection)),
        )
    ]
    return Levels(bins * design.rate / design.period, *found)


def spectra_of(design: Design, periods: Iterable[tuple[np.ndarray, np.ndarray]], first: int, last: int) -> Spectra:
    """Transform recorded periods, one at a time.

    Parameters
    ----------
    design : Design
    periods : iterable of (drive (period, inputs) V, response (period, outputs) m/s^2)
        Of a silence, and then of each record.
    first, last : int
        Bins.
    """
    lines = [tuple(amplitudes(part, first, last) for part in pair) for pair in periods]
    if len(lines) != 1 + design.records:
        raise ValueError(f"{len(lines) - 1} records, must be {design.records}")
    (_, silence), *records = lines
    drive, response = (np.stack(parts) for parts in zip(*records, strict=True))
    return Spectra(drive, response, silence, first)


def _averaged(power: np.ndarray, chosen: np.ndarray, reach: int) -> np.ndarray:
    """Average over the chosen bins within reach of each bin; the nearest value where there are none."""
    size = 2 * reach + 1
    total = uniform_filter1d(np.where(chosen[:, None], power, 0.0), size, axis=0, mode="constant")
    count = uniform_filter1d(chosen.astype(float), size, mode="constant")
    some = np.flatnonzero(count > 0.5 / size)
    place = some[np.clip(np.searchsorted(some, np.arange(len(power))), 0, len(some) - 1)]
    mean: np.ndarray = np.maximum(total[place], 0.0) / count[place][:, None]
    return mean
