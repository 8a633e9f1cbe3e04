"""What a stage does above the frequencies that its models are made of: how strongly it answers there at most."""

import numpy as np

RESOLUTION = 1.0
"""Hz, of the gains that are compared: as wide as a resonance, or less."""


def largest_gain(
    drive: np.ndarray, response: np.ndarray, rate: float, band: tuple[float, float], integrated: bool = False
) -> float:
    """Return the largest gain of a band that a chirp went through, in the response's unit per unit of drive.

    The gain of a cell is the root of the powers' ratio, so that noise can make it larger and not smaller.

    Parameters
    ----------
    drive, response : arrays, shape (N,), V or m
        From rest to rest.
    rate : float, samples/s
    band : (float, float), Hz
    integrated : bool, optional
        The gain is divided by the frequency, Hz, first, as behind an integrator.

    Examples
    --------
    >>> time = np.arange(20_000) / 10_000
    >>> chirp = np.sin(2 * np.pi * (200 * time + 150 * time**2))
    >>> round(largest_gain(chirp, 0.3 * chirp, 10_000.0, (220.0, 780.0)), 3)
    0.3
    """
    size = len(drive)
    low, high = (int(edge * size / rate) for edge in band)
    cells = max(1, int((band[1] - band[0]) / RESOLUTION))
    edges = np.linspace(low, high, cells + 1).astype(int)[:-1]
    given, heard = (
        np.add.reduceat(np.abs(np.fft.rfft(each)[low:high]) ** 2, edges - low) for each in (drive, response)
    )
    gain = np.sqrt(heard / given)
    return float(np.max(gain / (edges * rate / size) if integrated else gain))
