"""Where a measured response needs more lines, and how long it rings there: the second pass, chosen from the first."""

import numpy as np
from scipy.interpolate import Akima1DInterpolator

ORDER = 3
"""A halved interval makes the interpolation's error 2^3 times smaller (modified Akima's slopes are second order)."""
REACH = 2.0
"""Hz: what one line says holds this far to each side, since a first pass is too coarse to say just where."""


def interpolation_error(frequency: np.ndarray, response: np.ndarray) -> np.ndarray:
    """Predict the error of interpolating in each interval of a grid, relative to the size of the response there.

    Each line is left out and interpolated from those two to either side, on a grid twice as coarse; what that misses is
    2^3 times what the grid itself misses.  An interval takes the larger value of its two ends.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz, evenly spaced
    response : complex array, shape (bins, outputs, inputs), any unit

    Returns
    -------
    array, shape (bins - 1,), 1
    """
    missed = np.zeros(len(frequency))
    for first in (0, 1):
        kept = np.arange(len(frequency)) % 2 == first
        inside = ~kept & (frequency > frequency[kept][0]) & (frequency < frequency[kept][-1])
        found = _interpolated(frequency[kept], response[kept], frequency[inside])
        missed[inside] = _size(found - response[inside])
    relative = missed / _size(response) / 2**ORDER
    interval: np.ndarray = np.maximum(relative[:-1], relative[1:])
    return interval


def refined(frequency: np.ndarray, response: np.ndarray, tolerance: float, finest: float) -> np.ndarray:
    """Halve the intervals of a grid until each is predicted to interpolate within `tolerance`, or is `finest` wide.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz, evenly spaced
    response : complex array, shape (bins, outputs, inputs), any unit
    tolerance : float, 1, relative to the size of the response
    finest : float, Hz
        No interval is made smaller.

    Returns
    -------
    array, shape (at least bins,), Hz, rising
        The old lines are among the new ones.

    Source
    ------
    Sörnmo 2015, sec. 6.6: "adding more frequencies in these areas".
    """
    error = _spread(frequency, interpolation_error(frequency, response))
    wanted = np.ceil(np.log2(np.maximum(error / tolerance, 1.0)) / ORDER)
    most = np.floor(np.log2(np.maximum(np.diff(frequency) / finest * (1 + 1e-9), 1.0)))
    parts = 2 ** np.minimum(wanted, most).astype(int)
    inner = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(frequency, frequency[1:], parts, strict=False)]
    return np.concatenate([*inner, frequency[-1:]])


def memory(frequency: np.ndarray, response: np.ndarray) -> np.ndarray:
    """Return how long the response at each line rings: |dG/domega| / |G|, at a resonance its time constant.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    response : complex array, shape (bins, outputs, inputs), any unit

    Returns
    -------
    array, shape (bins,), s
    """
    slope = _size(np.diff(response, axis=0)) / (2 * np.pi * np.diff(frequency))
    seconds = slope / np.minimum(_size(response[:-1]), _size(response[1:]))
    spread = _spread(frequency, seconds)
    longest: np.ndarray = np.maximum(np.append(spread, spread[-1]), np.append(spread[0], spread))
    return longest


def _spread(frequency: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Return for each interval the largest value of those within reach."""
    middle = (frequency[:-1] + frequency[1:]) / 2
    first = np.searchsorted(middle, middle - REACH * (1 + 1e-9))
    last = np.searchsorted(middle, middle + REACH * (1 + 1e-9))
    return np.array([value[a:b].max() for a, b in zip(first, last, strict=True)])


def _interpolated(frequency: np.ndarray, response: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    parts = np.stack([response.real, response.imag], axis=-1)
    found = Akima1DInterpolator(frequency, parts, method="makima")(wanted)
    result: np.ndarray = found[..., 0] + 1j * found[..., 1]
    return result


def _size(response: np.ndarray) -> np.ndarray:
    size: np.ndarray = np.linalg.norm(response, 2, axis=(-2, -1))
    return size
