"""Auto and cross spectra by Welch's method, and the frequency response with coherence and variance that they give."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import csd, get_window

from calibration.records import as_records

_WINDOW = "hann"
_OVERLAP = 0.5
_RANK = 1e-12
"""Combinations of inputs weaker than this part of the strongest, each input in units of its own power, are not used."""


@dataclass(frozen=True)
class Spectra:
    """One-sided power spectral densities, means over overlapping segments.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    drive : complex array, shape (bins, m, m), products of the inputs' units per Hz
        E conj(U_i) U_j.
    cross : complex array, shape (bins, m, p), the inputs' times the outputs' units per Hz
        E conj(U_i) Y_j.
    response : complex array, shape (bins, p, p), products of the outputs' units per Hz
    averages : float, 1
        Independent segments that would have the same variance.

    Source
    ------
    Welch 1967, "The use of fast Fourier transform for the estimation of power spectra", IEEE Trans. Audio and
    Electroacoustics 15, 70-73.
    """

    frequency: np.ndarray
    drive: np.ndarray
    cross: np.ndarray
    response: np.ndarray
    averages: float


@dataclass(frozen=True)
class FrequencyResponse:
    """What spectra say of the response from inputs to outputs.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    response : complex array, shape (bins, p, m), the outputs' per the inputs' units
    variance : array, shape (bins, p, m), the square of that
        Of the complex estimate, E |G_hat - G|^2; infinite where an input is not excited.
    coherence : array, shape (bins, p), 0 to 1
        Part of each output's power that all inputs together explain.
    """

    frequency: np.ndarray
    response: np.ndarray
    variance: np.ndarray
    coherence: np.ndarray


def spectra(
    drive: np.ndarray | Sequence[np.ndarray],
    response: np.ndarray | Sequence[np.ndarray],
    rate: float,
    resolution: float,
) -> Spectra:
    """Estimate auto and cross spectra with Hann windows that overlap by half, each without its mean.

    Parameters
    ----------
    drive : array, shape (N, m), or a sequence of such, the inputs' units
    response : array, shape (N, p), or a sequence of such, the outputs' units
    rate : float, samples/s
    resolution : float, Hz
        Between bins.  A resonance at f of damping ratio d is 2 d f wide and wants several bins.

    Raises
    ------
    ValueError : unusable records, or a resolution that they do not allow.
    """
    drives, responses = as_records(drive, response)
    shortest = min(len(each) for each in drives)
    if not rate / shortest <= resolution <= rate / 8:
        raise ValueError(
            f"resolution is {resolution:g} Hz, must be {rate / shortest:g} (the shortest record) to {rate / 8:g} Hz"
        )
    length = round(rate / resolution)
    hop = length - int(length * _OVERLAP)
    counts = [(len(each) - length) // hop + 1 for each in drives]
    low_low, low_high, high_high = np.zeros(()), np.zeros(()), np.zeros(())
    for low, high, count in zip(drives, responses, counts, strict=True):
        share = count / sum(counts)
        low_low = low_low + share * _density(low, low, rate, length, hop)
        low_high = low_high + share * _density(low, high, rate, length, hop)
        high_high = high_high + share * _density(high, high, rate, length, hop)
    frequency = np.fft.rfftfreq(length, 1 / rate)
    return Spectra(frequency, low_low, low_high, high_high, _independent(counts, length, hop))


def frequency_response(estimated: Spectra) -> FrequencyResponse:
    """Return the least squares response of outputs to inputs, noise being on the outputs (H1).

    Parameters
    ----------
    estimated : Spectra

    Raises
    ------
    ValueError : fewer averages than would tell the inputs apart from noise.

    Source
    ------
    Bendat and Piersol 2010, Random Data, 4th ed., sections 7.4 and 9.2 (multiple inputs, random errors).
    """
    inputs = estimated.drive.shape[1]
    if not estimated.averages > inputs:
        raise ValueError(
            f"the spectra are means of {estimated.averages:.1f} segments, must be more than the {inputs} inputs: "
            "take longer records or a coarser resolution"
        )
    inverse = _inverse(estimated.drive)
    transposed = inverse @ estimated.cross
    power = np.real(np.einsum("boo->bo", estimated.response))
    explained = np.real(np.einsum("bmo,bmo->bo", estimated.cross.conj(), transposed))
    coherence = np.clip(np.divide(explained, power, out=np.zeros_like(power), where=power > 0), 0.0, 1.0)
    noise = power * (1 - coherence) / (estimated.averages - inputs)
    weights = np.real(np.einsum("bmm->bm", inverse))
    variance = np.where(weights[:, None, :] > 0, noise[:, :, None] * weights[:, None, :], np.inf)
    return FrequencyResponse(estimated.frequency, transposed.swapaxes(1, 2), variance, coherence)


def _density(one: np.ndarray, other: np.ndarray, rate: float, length: int, hop: int) -> np.ndarray:
    """Return the spectra of every signal of one record with every one of the other, shape (bins, width, width)."""
    _, density = csd(
        one.T[:, None, :], other.T[None, :, :], fs=rate, window=_WINDOW, nperseg=length, noverlap=length - hop
    )
    return np.moveaxis(density, -1, 0)


def _independent(counts: list[int], length: int, hop: int) -> float:
    """Return how many independent segments so many overlapping ones are worth (Welch 1967)."""
    window = get_window(_WINDOW, length)
    shares = [
        float(window[shift:] @ window[: length - shift] / (window @ window)) ** 2 for shift in range(hop, length, hop)
    ]
    worth = [
        count / (1 + 2 * sum((1 - lag / count) * share for lag, share in enumerate(shares, 1) if lag < count))
        for count in counts
    ]
    return float(sum(worth))


def _inverse(drive: np.ndarray) -> np.ndarray:
    """Invert the inputs' spectra bin by bin; what is not excited is left at zero."""
    size = np.sqrt(np.real(np.einsum("bmm->bm", drive)))
    size = np.where(size > 0, size, 1.0)
    weights = size[:, :, None] * size[:, None, :]
    inverse: np.ndarray = np.linalg.pinv(drive / weights, rcond=_RANK, hermitian=True) / weights
    return inverse
