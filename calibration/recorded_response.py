"""The transfer matrix from lines of any recordings: local polynomials, with a transient of each block.

Around each line wanted G is a polynomial of frequency, the same in all blocks.  What a block was not at rest for, or
did not hear the end of, is another polynomial, of each block its own; a periodic signal that has settled has none.
Blocks are added up as normal equations, so that the length of a recording takes no memory.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d


@dataclass(frozen=True)
class Reach:
    """A local polynomial.

    Parameters
    ----------
    degree : int
    width : float, Hz
        To each side, that it reaches over.
    """

    degree: int
    width: float


REACHES = (Reach(2, 1.0), Reach(4, 2.0), Reach(4, 4.0))
"""From narrow to wide: the first follows narrow resonances, the last averages most."""
AROUND = 8
"""Lines to each side over which a block's noise is averaged, for its weight."""
FREE = 8
"""Rows beyond unknowns from which on a block tells its noise."""
LEAST = 1e-14
"""Of all responses' power: noise is no less."""
RIDGE = 1e-9
"""Of the strongest combination of drives, each in units of its own: weaker ones are not fitted in a block ..."""
RANK = 1e-10
"""... and tell nothing in all of them together."""
CHUNK = 128
"""Lines worked on at a time."""


@dataclass(frozen=True)
class Spectrum:
    """One block in lines.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz, rising; evenly spaced unless `is_steady`
    drive : complex array, shape (bins, inputs), V s
    response : complex array, shape (bins, outputs), m/s^2 s
    middle : float, s
        When it was, from the record's beginning on.
    is_steady : bool
        Whole periods of a periodic signal that has settled, its excited lines alone.
    fresh : float, 0 to 1
        Part of the block that was recorded: silence put before it makes more bins, but tells no more.
    """

    frequency: np.ndarray
    drive: np.ndarray
    response: np.ndarray
    middle: float = 0.0
    is_steady: bool = False
    fresh: float = 1.0

    @property
    def spacing(self) -> float:
        """Hz between neighbours; for lines that are not all excited, the median."""
        return float(np.median(np.diff(self.frequency)))


@dataclass(frozen=True)
class Evidence:
    """What a block says of G around each line, k being the coefficients of a row of it.

    Parameters
    ----------
    square : complex array, shape (lines, k, k), (V s)^2
    right : complex array, shape (lines, k, outputs), V s m/s^2 s
    power : array, shape (lines, outputs), (m/s^2 s)^2
        Of the response in the window, without what a transient may be.
    rows : float
        Free equations in a window.
    rank : array, shape (lines,), 1
        Coefficients that the block's own fit has.
    left : array, shape (lines, outputs), (m/s^2 s)^2
        Power that this fit leaves.
    excited : array, shape (lines, inputs), V s
        RMS of each drive in the window, without what a transient may be.
    """

    square: np.ndarray
    right: np.ndarray
    power: np.ndarray
    rows: float
    rank: np.ndarray
    left: np.ndarray
    excited: np.ndarray


def evidence(record: Spectrum, wanted: np.ndarray, reach: Reach) -> Evidence:
    """Sum up what a block says around each line.

    Parameters
    ----------
    record : Spectrum
    wanted : array, shape (lines,), Hz
    reach : Reach
    """
    place, rows = _windows(record, wanted, reach)
    whole: list[np.ndarray] = []
    for first in range(0, len(wanted), CHUNK):
        lines = slice(first, first + CHUNK)
        *told, excited = _of_lines(record, wanted[lines], place[lines], reach)
        square, right, power = (record.fresh * each for each in told)
        parts = (square, right, power, *_own_fit(square, right, power), excited)
        whole = whole or [np.empty((len(wanted), *part.shape[1:]), part.dtype) for part in parts]
        for each, part in zip(whole, parts, strict=True):
            each[lines] = part
    square, right, power, rank, left, excited = whole
    return Evidence(square, right, power, rows, rank, left, excited)


def noise_of(found: Evidence, windows: float = 1.0, wider: np.ndarray | None = None) -> np.ndarray:
    """Return the power of a row that a block's own fit leaves, (lines, outputs), (m/s^2 s)^2, averaged over lines.

    Parameters
    ----------
    found : Evidence
    windows : float
        How many of its windows the widest one holds.
    wider : array, shape (lines, outputs), (m/s^2 s)^2, optional
        The same of the next wider reach: it stands for one that leaves too few rows to tell.
    """
    free = found.rows - found.rank
    if wider is not None and np.median(free) * windows < FREE:
        return wider
    least = LEAST * found.power.mean() / max(found.rows, 1.0) + 1e-60
    left = found.left / np.maximum(free, 1.0)[:, None]
    smooth = uniform_filter1d(left, 2 * AROUND + 1, axis=0, mode="mirror")
    noise: np.ndarray = np.maximum(smooth, least)
    return noise


def around(value: np.ndarray, how: Callable[..., np.ndarray], lines: int = 2) -> np.ndarray:
    """Return means or medians over some lines to each side.

    Parameters
    ----------
    value : array, shape (lines, ...), any unit
    how : numpy.mean or numpy.median
    lines : int
    """
    padded = np.pad(value, ((lines, lines), *((0, 0),) * (value.ndim - 1)), mode="reflect")
    return how(np.lib.stride_tricks.sliding_window_view(padded, 2 * lines + 1, axis=0), axis=-1)


def _windows(record: Spectrum, wanted: np.ndarray, reach: Reach) -> tuple[np.ndarray, float]:
    """Return the bins around each line, (lines, bins), and how many equations are free."""
    frequency, inputs = record.frequency, record.drive.shape[1]
    side = max(round(reach.width / record.spacing), 1)
    if record.is_steady:
        side = max(side, (reach.degree + 1) * inputs // 2 + 1)
    side = min(side, (len(frequency) - 1) // 2)
    above = np.clip(np.searchsorted(frequency, wanted), 1, len(frequency) - 1)
    nearest = above - (wanted - frequency[above - 1] < frequency[above] - wanted)
    centre = np.clip(nearest, side, len(frequency) - 1 - side)
    rows = 2 * side + 1 if record.is_steady else max(record.fresh * (2 * side + 1) - reach.degree - 1, 0.0)
    return centre[:, None] + np.arange(-side, side + 1), rows


def _of_lines(record: Spectrum, wanted: np.ndarray, place: np.ndarray, reach: Reach) -> tuple[np.ndarray, ...]:
    """Return square, right, power and excited of some lines."""
    offset = (record.frequency[place] - wanted[:, None]) / reach.width
    powers = offset[:, :, None] ** np.arange(reach.degree + 1)
    driven = (powers[..., None] * record.drive[place][:, :, None, :]).reshape(*place.shape, -1)
    heard = record.response[place].astype(complex)
    if not record.is_steady:
        index = np.linspace(-1, 1, place.shape[1])
        basis = np.linalg.qr(index[:, None] ** np.arange(min(reach.degree + 1, len(index))))[0]
        for each in (driven, heard):
            each -= basis @ (basis.T @ each)
    turned = driven.conj().swapaxes(1, 2)
    square, right = turned @ driven, turned @ heard
    power = (np.abs(heard) ** 2).sum(axis=1)
    inputs = record.drive.shape[1]
    near = np.abs(offset).min(axis=1) * reach.width <= max(reach.width, 2 * record.spacing)
    own = np.real(np.einsum("lii->li", square[:, :inputs, :inputs])) * near[:, None] / place.shape[1]
    return square, right, power, np.sqrt(own)


def _own_fit(square: np.ndarray, right: np.ndarray, power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how many coefficients a block tells, (lines,), and the power that they leave, (lines, outputs)."""
    size = np.sqrt(np.maximum(np.real(np.einsum("lkk->lk", square)), 0.0))
    safe = np.where(size > 0, size, 1.0)
    scaled = square / (safe[:, :, None] * safe[:, None, :]) + RIDGE * np.eye(square.shape[1])
    inverse = np.linalg.inv(scaled)
    rank = square.shape[1] - RIDGE * np.real(np.einsum("lkk->l", inverse))
    share = right / safe[:, :, None]
    explained = np.real((share.conj() * (inverse @ share)).sum(axis=1))
    return rank, np.clip(power - explained, 0.0, None)
