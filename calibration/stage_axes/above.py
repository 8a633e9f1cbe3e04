"""What a stage does within the frequencies that its models are made of, and above: as heard, without a model."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stagectl.stage.measured_response import near

RESOLUTION, MOSTLY = 1.0, 0.5
"""Hz, of a cell: as wide as a resonance, or less; and part of the cells in which a stage was heard, where it was."""
WIDER = 1, 5, 17
"""Cells that are taken together, in turn, until more of the response follows the drive than noise would."""
BY_CHANCE = 1e-6
"""How probable it is, at most, that noise follows as much."""


@dataclass(frozen=True, eq=False)
class HeardResponse:
    """How a stage answers, over frequency.

    Parameters
    ----------
    frequency : array, shape (cells,), Hz
        Where each cell begins.
    response : complex array, shape (cells,), the response's unit per unit of drive
        0 where noise may be all that follows the drive.
    """

    frequency: np.ndarray
    response: np.ndarray

    @property
    def gain(self) -> np.ndarray:
        """Its magnitude, shape (cells,)."""
        magnitude: np.ndarray = np.abs(self.response)
        return magnitude

    def near(self, frequency: np.ndarray, spread: float) -> np.ndarray:
        """Return the largest gain near each of some frequencies, shape (bins,), the response's unit per unit of drive.

        Where the chirp did not go up to all that is near, or more of that was noise than not, it is the largest of all.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        spread : float, 1
            How far away still counts, of the frequency: resonances may be elsewhere another day.
        """
        low, high = near(self.frequency, frequency, spread, RESOLUTION)
        went = (low < high) & (frequency * (1 + spread) <= self.frequency[-1] + RESOLUTION)
        bins = zip(low, high, went, strict=True)
        around = (self.gain[first:last] if inside else self.gain[:0] for first, last, inside in bins)
        heard = (each if len(each) > 0 and np.mean(each > 0) > MOSTLY else self.gain for each in around)
        return np.array([each.max() for each in heard])


def heard_response(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], rate: float, band: tuple[float, float]
) -> HeardResponse:
    """Return the response in a band that chirps went through, cell by cell; noise counts as nothing.

    Parameters
    ----------
    drives, responses : sequences of arrays, each of shape (N,), V or m
        Each from rest to rest.
    rate : float, samples/s
    band : (float, float), Hz

    Examples
    --------
    >>> time = np.arange(20_000) / 10_000
    >>> chirp = np.sin(2 * np.pi * (200 * time + 150 * time**2))
    >>> heard_response([chirp], [0.3 * chirp], 10_000.0, (220.0, 780.0)).gain.max().round(3)
    np.float64(0.3)

    Source
    ------
    Ljung, System Identification, 2nd ed., 1999, section 6.4: averaged over neighbouring frequencies.  Bendat and
    Piersol, Random Data, 4th ed., 2010, section 9.2.3: noise reaches a coherence of c with the probability
    (1 - c)^(n - 1), n bins averaged.
    """
    edges = np.linspace(*band, max(1, int((band[1] - band[0]) / RESOLUTION)) + 1)
    cells = sum(
        (_cells(drive, response, rate, edges) for drive, response in zip(drives, responses, strict=True)),
        start=np.zeros((4, len(edges) - 1), complex),
    )
    found = np.zeros(len(edges) - 1, complex)
    for width in reversed(WIDER):
        wide = np.array([np.convolve(each, np.ones(width), "same") for each in cells])
        power, moved, bins = wide[0].real, wide[2].real, wide[3].real
        least = 1.0 - BY_CHANCE ** (1.0 / np.maximum(bins - 1.0, 1.0))
        follows = np.abs(wide[1]) ** 2 > least * power * moved
        found = np.where(follows, wide[1] / np.where(follows, power, 1.0), found)
    return HeardResponse(edges[:-1], found)


def _cells(drive: np.ndarray, response: np.ndarray, rate: float, edges: np.ndarray) -> np.ndarray:
    """Return of each cell the drive's power, its cross power with the response, that one's, and bins: (4, cells)."""
    first, *_, last = at = (edges * len(drive) / rate).astype(int)
    given, heard = (np.fft.rfft(each)[first:last] for each in (drive, response))
    each_bin = np.abs(given) ** 2, heard * given.conj(), np.abs(heard) ** 2, np.ones(len(given))
    return np.array([np.add.reduceat(each, at[:-1] - first) for each in each_bin], complex)
