"""The complex amplitude of a weak tone beside strong ones: windowed least squares, with its variance."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

NEIGHBOURS = 40.0
"""Hz around the tone from which the noise is taken ..."""
CLEAR = 2.5
"""... but so many lines (1 / window) away from it and from every harmonic."""


@dataclass(frozen=True)
class LineFit:
    """Amplitudes at one frequency.

    Parameters
    ----------
    amplitude : complex array, shape (signals,), the signal's unit
        x(n) = Re amplitude exp(j 2 pi f n / rate), n counted from the window's first sample.
    variance : array, shape (signals,), the signal's unit squared
        Of the complex amplitude, from the noise around the line.
    """

    amplitude: np.ndarray
    variance: np.ndarray


class LineEstimator:
    """Fits a tone, a constant and other tones to windows of signals.

    Weighted least squares with the window as weight.  Its right-hand side is the windowed DFT (6.4); where window and
    frequencies make the tones orthogonal it is the windowed DFT, times two over the window's sum.

    Parameters
    ----------
    window : array, shape (samples,), 1
    rate : float, samples/s
    tone : float, Hz
    others : array, shape (lines,), Hz
        Lines that stand beside the tone: what they would leak into it is explained by them instead.

    Source
    ------
    Sörnmo 2015, eq. (6.3), (6.4).

    Departs
    -------
    The text transforms the tapered data at f alone.  A preload 20 dB above the probe leaks through the taper, most
    where the response is weak.
    """

    def __init__(self, window: np.ndarray, rate: float, tone: float, others: np.ndarray) -> None:
        self._window = window
        lines = np.append(tone, others)
        angle = 2 * np.pi / rate * np.outer(np.arange(len(window)), lines)
        self._basis = np.concatenate([np.cos(angle), -np.sin(angle), np.ones((len(window), 1))], axis=1)
        self._weighted = window[:, None] * self._basis
        self._factor = cho_factor(self._weighted.T @ self._basis)
        self._parts = [0, len(lines)]  # where the solution holds the tone's real and imaginary part
        pick = np.zeros((self._basis.shape[1], 2))
        pick[self._parts, [0, 1]] = 1.0
        self._gain = float(np.sum((self._weighted @ cho_solve(self._factor, pick)) ** 2))
        self._quiet = _quiet_bins(len(window), rate, tone, np.append(lines, 0.0))

    def fit(self, signals: np.ndarray) -> LineFit:
        """Fit `signals`, shape (samples, signals), all at once.

        The noise's density is the median over the bins around the tone, so that a few lines of other origin do not
        count as noise.
        """
        solution = cho_solve(self._factor, self._weighted.T @ signals)
        real, imaginary = solution[self._parts]
        residual = signals - self._basis @ solution
        bins = np.fft.rfft(self._window[:, None] * residual, axis=0)[self._quiet]
        density = np.median(np.abs(bins) ** 2, axis=0) / np.log(2) / np.sum(self._window**2)
        return LineFit(real + 1j * imaginary, density * self._gain)


def background(silence: np.ndarray, window: np.ndarray, rate: float, tone: float) -> np.ndarray:
    """Return what is heard at a frequency without a drive, as the variance it gives an amplitude there.

    Parameters
    ----------
    silence : array, shape (samples, signals), any unit
        At least as long as the window.
    window : array, shape (samples,), 1
    rate : float, samples/s
    tone : float, Hz

    Returns
    -------
    array, shape (signals,), the signal's unit squared
        Mean over windows that overlap by half.
    """
    frames = len(window)
    starts = range(0, len(silence) - frames + 1, frames // 2)
    kernel = window * np.exp(-2j * np.pi * tone / rate * np.arange(frames)) * 2 / window.sum()
    heard = np.stack([kernel @ silence[start : start + frames] for start in starts])
    power: np.ndarray = np.mean(np.abs(heard) ** 2, axis=0)
    return power


def _quiet_bins(frames: int, rate: float, tone: float, lines: np.ndarray) -> np.ndarray:
    """Find the bins near the tone but away from every line."""
    bins = np.fft.rfftfreq(frames, 1 / rate)
    apart = np.abs(bins[:, None] - lines).min(axis=1) >= CLEAR * rate / frames
    return np.flatnonzero(apart & (np.abs(bins - tone) <= NEIGHBOURS))
