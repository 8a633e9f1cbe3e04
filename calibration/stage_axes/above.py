"""What a stage does above the frequencies that its models are made of: how strongly it answers there at most."""

from dataclasses import dataclass

import numpy as np

RESOLUTION, COHERENT, MOSTLY = 1.0, 0.8, 0.5
"""Hz, of a cell: as wide as a resonance, or less; part of a cell's response that follows the drive, where any does; and
part of the cells in which it does, where a stage was heard."""


@dataclass(frozen=True, eq=False)
class HeardGain:
    """How strongly a stage answers at most, over frequency.

    Parameters
    ----------
    frequency : array, shape (cells,), Hz
        Where each cell begins.
    gain : array, shape (cells,), the response's unit per unit of drive
        0 where little of the response follows the drive: noise.
    """

    frequency: np.ndarray
    gain: np.ndarray

    def near(self, frequency: np.ndarray, spread: float) -> np.ndarray:
        """Return the largest gain near each of some frequencies, shape (bins,), the response's unit per unit of drive.

        Where the chirp did not go up to all that is near, or more of that was noise than not, it is the largest of all.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        spread : float, 1
            How far away still counts, of the frequency: resonances may be elsewhere another day.
        """
        low = np.searchsorted(self.frequency, frequency * (1 - spread) - RESOLUTION)
        high = np.searchsorted(self.frequency, frequency * (1 + spread), side="right")
        went = (low < high) & (frequency * (1 + spread) <= self.frequency[-1] + RESOLUTION)
        bins = zip(low, high, went, strict=True)
        near = (self.gain[first:last] if inside else self.gain[:0] for first, last, inside in bins)
        heard = (each if len(each) > 0 and np.mean(each > 0) > MOSTLY else self.gain for each in near)
        return np.array([each.max() for each in heard])


def heard_gain(drive: np.ndarray, response: np.ndarray, rate: float, band: tuple[float, float]) -> HeardGain:
    """Return the gain of a band that a chirp went through, cell by cell; noise counts as nothing.

    Parameters
    ----------
    drive, response : arrays, shape (N,), V or m
        From rest to rest.
    rate : float, samples/s
    band : (float, float), Hz

    Examples
    --------
    >>> time = np.arange(20_000) / 10_000
    >>> chirp = np.sin(2 * np.pi * (200 * time + 150 * time**2))
    >>> heard_gain(chirp, 0.3 * chirp, 10_000.0, (220.0, 780.0)).gain.max().round(3)
    np.float64(0.3)
    """
    frequency, power, followed, moved = _cells(drive, response, rate, band)
    follows = np.abs(followed) ** 2 > COHERENT * power * moved
    return HeardGain(frequency, np.where(follows, np.abs(followed) / power, 0.0))


def _cells(
    drive: np.ndarray, response: np.ndarray, rate: float, band: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return of each cell its frequency, the drive's power, its cross power with the response and that one's power."""
    size = len(drive)
    low, high = (int(edge * size / rate) for edge in band)
    cells = max(1, int((band[1] - band[0]) / RESOLUTION))
    edges = np.linspace(low, high, cells + 1).astype(int)[:-1]
    given, heard = (np.fft.rfft(each)[low:high] for each in (drive, response))
    each_cell = (np.abs(given) ** 2, heard * given.conj(), np.abs(heard) ** 2)
    power, followed, moved = (np.add.reduceat(each, edges - low) for each in each_cell)
    return edges * rate / size, power, followed, moved
