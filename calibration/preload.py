"""Where the preload is put, so that neither its harmonics nor its mixing products fall on the probe."""

import numpy as np

CLEARANCE = 12.0
"""Hz: three of the tone window's main lobes."""
ORDERS = 3
"""Mixing products m f0 - (p - 1) f are kept off the probe for p = 1 (the harmonics), 2 (the images) and 3."""
_CANDIDATES = 2001


def preload_frequencies(probe: np.ndarray, band: tuple[float, float]) -> np.ndarray:
    """Choose the preload's frequency for each probe.

    Of all frequencies of the band that keep harmonics and mixing products clear of the probe, the one nearest the
    band's middle (on a logarithmic scale): the operating point that the lines are measured at should be one and the
    same.  Where none is clear enough, the clearest.  As the probe moves on, the preload glides along with it, and
    steps over to the other side of a harmonic when that has come nearer the middle.

    Parameters
    ----------
    probe : array, shape (tones,), Hz
    band : (float, float), Hz
        Where the preload may lie.

    Returns
    -------
    array, shape (tones,), Hz

    Source
    ------
    Sörnmo 2015, eq. (6.2): "chosen such that its harmonics do not coincide with the frequency of interest".

    Departs
    -------
    The text does not say how.  Farthest from the harmonics would be f = (n + 1/2) f0; but there the image
    (2 n + 1) f0 - f, the response's own beat with the preload, is at the probe itself.

    Examples
    --------
    >>> preload_frequencies(np.array([210.0, 600.0]), (40.0, 90.0)).round(1)
    array([60.9, 61.2])
    """
    candidates = np.geomspace(*band, _CANDIDATES)
    clear = clearance(probe[:, None], candidates)
    middle = np.abs(np.log(candidates / np.sqrt(band[0] * band[1])))
    nearest = np.where(clear >= CLEARANCE, middle, np.inf).argmin(axis=1)
    chosen: np.ndarray = candidates[np.where(clear.max(axis=1) >= CLEARANCE, nearest, clear.argmax(axis=1))]
    return chosen


def clearance(probe: np.ndarray, preload: np.ndarray) -> np.ndarray:
    """Return how far from the probe the preload's harmonics and mixing products stay.

    Parameters
    ----------
    probe, preload : arrays that broadcast, Hz

    Returns
    -------
    array, Hz
        The distance of the next harmonic, or p times that of the next m f0 - (p - 1) f, if that is less.
    """
    distances = []
    for order in range(1, ORDERS + 1):
        cycles = order * probe / preload
        distances.append(order * preload * np.abs(cycles - np.round(cycles)))
    nearest: np.ndarray = np.min(distances, axis=0)
    return nearest
