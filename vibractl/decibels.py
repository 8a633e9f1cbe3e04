"""Levels in dB, and the rms of signals."""

import numpy as np

FAINT = 1e-12
"""Smallest amplitude that is given in dB, to keep silence finite."""


def decibels(ratio: np.ndarray | float) -> np.ndarray:
    """Return 20 log10 |ratio|, (6.1), dB, of the same shape as `ratio`: a number or an array of any shape."""
    level: np.ndarray = 20 * np.log10(np.maximum(np.abs(ratio), FAINT))
    return level


def rms(signal: np.ndarray) -> np.ndarray:
    """Return the rms of each column of a signal, shape (samples, columns), any unit: (columns,)."""
    level: np.ndarray = np.sqrt(np.mean(np.abs(signal) ** 2, axis=0))
    return level
