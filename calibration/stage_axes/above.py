"""What a stage does above the frequencies that its models are made of: how strongly it answers there at most."""

import numpy as np

RESOLUTION, COHERENT = 1.0, 0.8
"""Hz, of a cell: as wide as a resonance, or less; part of a cell's response that follows the drive, where any does."""


def largest_gain(
    drive: np.ndarray, response: np.ndarray, rate: float, band: tuple[float, float], integrated: bool = False
) -> float:
    """Return the largest gain of a band that a chirp went through, in the response's unit per unit of drive.

    Frequencies are taken together in cells; one in which little of the response follows the drive is noise,
    and counts as nothing.

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
    given, heard = (np.fft.rfft(each)[low:high] for each in (drive, response))
    each_cell = (np.abs(given) ** 2, heard * given.conj(), np.abs(heard) ** 2)
    power, followed, moved = (np.add.reduceat(each, edges - low) for each in each_cell)
    follows = np.abs(followed) ** 2 > COHERENT * power.real * moved.real
    gain = np.where(follows, np.abs(followed) / power.real, 0.0)
    return float(np.max(gain / (edges * rate / size) if integrated else gain))
