"""A recording looked at slower: what a vibrator does lies far below its rate."""

import numpy as np
from scipy.signal import firwin, upfirdn

from vibractl.spectrum import DECIMATOR_BETA

FACTORS = (32, 16, 8, 4, 2)
OVER = 8.0
"""Times a reference's highest frequency, which the lower rate is at least: splines of fifth order move it exactly."""
WITHIN = 0.999
"""Of a reference's energy, below its highest frequency."""
REACH = 8
"""Taps of the low-pass to each side, times the factor."""
CORNER = 0.6
"""Of the lower Nyquist frequency: 100 dB are reached there."""


def slow_factor(reference: np.ndarray, rate: float) -> int:
    """Return by which factor recordings of a reference may be slower.

    Parameters
    ----------
    reference : array, shape (frames, sides), any unit
    rate : float, samples/s
    """
    energy = (np.abs(np.fft.rfft(reference, axis=0)) ** 2).sum(axis=1).cumsum()
    highest = rate / len(reference) * int(np.searchsorted(energy, WITHIN * energy[-1]))
    return next((factor for factor in FACTORS if rate / factor >= OVER * highest), 1)


class SlowView:
    """Keeps every `factor`-th sample behind a linear-phase low-pass, block after block, its delay compensated.

    Parameters
    ----------
    factor : int, >= 1
    channels : int
    """

    def __init__(self, factor: int, channels: int) -> None:
        self.factor = factor
        self._reach = REACH * factor if factor > 1 else 0
        self._known = np.zeros((self._reach, channels))
        if factor > 1:
            self._taps = firwin(2 * self._reach + 1, CORNER / factor, window=("kaiser", DECIMATOR_BETA))

    def follow(self, block: np.ndarray) -> np.ndarray:
        """Take the next block (samples, channels); return what it settles (fewer samples, channels), in its unit."""
        if self.factor == 1:
            return block
        known = np.concatenate((self._known, block))
        settled = max((len(known) - 1) // self.factor - 2 * REACH + 1, 0)
        self._known = known[settled * self.factor :]
        if not settled:
            return known[:0]
        full = upfirdn(self._taps, known, 1, self.factor, axis=0)
        kept: np.ndarray = full[2 * REACH : 2 * REACH + settled]
        return kept

    def end(self) -> np.ndarray:
        """Return what is left, (samples, channels), with silence behind it."""
        left = -(-(len(self._known) - self._reach) // self.factor)
        return self.follow(np.zeros((self._reach, self._known.shape[1])))[:left]


def slow(signal: np.ndarray, factor: int) -> np.ndarray:
    """Return a whole signal (samples, channels) as it is seen slower, (samples / factor, channels), in its unit."""
    view = SlowView(factor, signal.shape[1])
    return np.concatenate((view.follow(signal), view.end()))
