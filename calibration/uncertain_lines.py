"""Which lines of a multisine's model a short stepped sine should look at again, and both put together."""

import numpy as np

from vibractl.transfer_matrix import TransferMatrix, norm

MOST = 40
"""Tones at most, 50 s or so of signal for two coils."""
UNCERTAIN = 2.0
"""Times the median relative deviation, from where on a line is uncertain."""


def uncertain_lines(matrix: TransferMatrix) -> np.ndarray:
    """Choose the lines whose relative deviation stands out: narrow notches and resonances, where polynomials miss.

    Parameters
    ----------
    matrix : TransferMatrix

    Returns
    -------
    array, shape (at most MOST,), Hz, rising
        Every other line of each uncertain place, the worst places first where there are too many.
    """
    relative = np.sqrt(matrix.variance.sum(axis=(1, 2))) / norm(matrix.response)
    every_other = np.arange(1, len(relative) - 1, 2)
    doubtful = every_other[relative[every_other] > UNCERTAIN * np.median(relative)]
    worst = doubtful[np.argsort(relative[doubtful])[::-1][:MOST]]
    chosen: np.ndarray = matrix.frequency[np.sort(worst)]
    return chosen


def merged(matrix: TransferMatrix, tones: TransferMatrix) -> TransferMatrix:
    """Weigh the tones into the lines that they were measured at, each by its variance.

    The two have different operating points.  By how much they disagree beyond their variances, over all tones, is
    added to the variance of the tones: they count where they are surer than that.

    Parameters
    ----------
    matrix, tones : TransferMatrix
        Every line of `tones` is one of `matrix`.

    Raises
    ------
    ValueError : a tone that is no line of the matrix.
    """
    place = np.searchsorted(matrix.frequency, tones.frequency - 1e-6)
    if not np.allclose(matrix.frequency[np.minimum(place, len(matrix.frequency) - 1)], tones.frequency, atol=1e-6):
        raise ValueError("the tones must lie on bins of the matrix")
    old, doubt = matrix.response[place], matrix.variance[place]
    size = norm(old)[:, None, None]
    beyond = np.maximum(np.median((np.abs(tones.response - old) ** 2 - doubt - tones.variance) / size**2), 0.0)
    surely = tones.variance + beyond * size**2
    share = doubt / (doubt + surely)
    response, variance, coherence = matrix.response.copy(), matrix.variance.copy(), matrix.coherence.copy()
    response[place] = old + share * (tones.response - old)
    variance[place] = share * surely
    coherence[place] = np.maximum(coherence[place], np.where(share > 0.5, tones.coherence, 0.0))
    return TransferMatrix(matrix.frequency, response, variance, coherence, matrix.provenance)
