"""A plant of two inputs and two outputs that SciPy alone runs, and its transfer function: 1 kHz, four damped modes."""

import numpy as np
from scipy.signal import bilinear, freqz, lfilter

RATE = 1_000
MODES = ((38.0, 0.03), (61.0, 0.02), (97.0, 0.03), (140.0, 0.02))
"""Hz and damping ratio."""
ENTERS = np.array([[1.0, 0.6], [0.8, -1.0], [-0.5, 1.0], [1.0, 0.9]])
SEEN = np.array([[1.0, 0.7], [0.9, -0.8], [0.6, 1.0], [-1.0, 0.8]])
"""Of each mode, by each input and each output."""


def _filters(rate: float) -> list[tuple[np.ndarray, np.ndarray]]:
    omegas = [(2 * np.pi * frequency, damping) for frequency, damping in MODES]
    return [bilinear([omega**2], [1.0, 2 * zeta * omega, omega**2], rate) for omega, zeta in omegas]


def response(drive: np.ndarray, noise: float = 0.01, seed: int = 0, rate: float = RATE) -> np.ndarray:
    """Return what comes of a drive (samples, 2), with white noise of that part of its rms."""
    heard = np.zeros(drive.shape)
    for (numerator, denominator), enters, seen in zip(_filters(rate), ENTERS, SEEN, strict=True):
        heard += np.outer(lfilter(numerator, denominator, drive @ enters), seen)
    return heard + noise * heard.std(axis=0) * np.random.default_rng(seed).standard_normal(heard.shape)


def truth(frequency: np.ndarray, rate: float = RATE) -> np.ndarray:
    """Return the transfer matrix, (lines, 2, 2)."""
    total = np.zeros((len(frequency), 2, 2), complex)
    for (numerator, denominator), enters, seen in zip(_filters(rate), ENTERS, SEEN, strict=True):
        total += freqz(numerator, denominator, frequency, fs=rate)[1][:, None, None] * np.outer(seen, enters)
    return total


def white(seed: int, samples: int) -> np.ndarray:
    """Return independent noise on both inputs, of rms 1."""
    return np.random.default_rng(seed).standard_normal((samples, 2))


def off(found: np.ndarray, frequency: np.ndarray, rate: float = RATE) -> float:
    """Return the error of a transfer matrix (lines, 2, 2), as a part of the true one."""
    true = truth(frequency, rate)
    return float(np.linalg.norm(found - true) / np.linalg.norm(true))
