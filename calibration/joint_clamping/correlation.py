"""How far what a fit leaves is correlated: of so many samples one is independent."""

import numpy as np


def correlation_length(residual: np.ndarray) -> float:
    """Return 1 + 2 x the sum of the autocorrelation up to its first zero, in samples.

    Parameters
    ----------
    residual : array, shape (samples,), any unit
    """
    spectrum = np.abs(np.fft.rfft(residual - residual.mean(), 2 * len(residual))) ** 2
    correlation = np.fft.irfft(spectrum)[: len(residual)]
    correlation = correlation / max(float(correlation[0]), 1e-300)
    negative = np.flatnonzero(correlation <= 0)
    return float(2 * correlation[: negative[0] if len(negative) else None].sum() - 1)
