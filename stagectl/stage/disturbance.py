"""How a disturbance moves: its spectral density, from a recording of it."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import welch

SEGMENT = 4.0
"""s of a segment that a density is averaged from."""
SPREAD = 0.08
"""Re each frequency: as far as what rings there may be elsewhere in the next cut."""
FLOOR = 0.03
"""Of the whole power, spread over all octaves: nothing that was not seen is believed not to come."""


@dataclass(frozen=True, eq=False)
class Disturbance:
    """What was seen of a disturbance of one axis.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    density : array, shape (bins,), m^2/Hz
        One-sided.
    """

    frequency: np.ndarray
    density: np.ndarray

    def power(self, frequency: np.ndarray, usual: float) -> np.ndarray:
        """Return the power that each of some frequencies stands for, shape (bins,), m^2, as wide as it may come again.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz, > 0
            Rising.
        usual : float, Hz
            Of what was not seen, each octave up to here has as much, and less beyond.
        """
        widths = np.gradient(frequency)
        step = self.frequency[1] - self.frequency[0]
        summed = np.concatenate([[0.0], np.cumsum(self.density)])
        low = np.searchsorted(self.frequency, frequency * (1 - SPREAD) - step)
        high = np.searchsorted(self.frequency, frequency * (1 + SPREAD) + step, side="right")
        seen = (summed[high] - summed[low]) / np.maximum(high - low, 1) * widths
        unseen = np.where(frequency < usual, 1.0, usual / frequency) / frequency * widths
        whole: np.ndarray = seen + FLOOR * (seen.sum() / unseen.sum()) * unseen
        return whole


def disturbance(samples: np.ndarray, rate: float) -> Disturbance:
    """Return how a disturbance moves.

    Parameters
    ----------
    samples : array, shape (N,), m
    rate : float, samples/s

    Raises
    ------
    ValueError : there are fewer samples than a segment has, or one that is no number.

    Source
    ------
    Welch 1967, IEEE Trans. Audio Electroacoust. 15, 70-73.
    """
    segment = round(SEGMENT * rate)
    if len(samples) < segment:
        raise ValueError(f"the disturbance has {len(samples) / rate:.3g} s, must have {SEGMENT:g} s or more")
    if not np.isfinite(samples).all():
        raise ValueError("the disturbance is not finite everywhere")
    return Disturbance(*welch(samples, rate, nperseg=segment, detrend="constant"))
