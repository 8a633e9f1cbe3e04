"""Measured (and one simulated) input-output records of others, cut as published comparisons cut them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.io

from tests.shared_data import DATA

Pair = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Case:
    """One record, an order and a horizon, with what others reached on it.

    Parameters
    ----------
    name : str
    order, horizon : int
    own, fresh : (drive, response), arrays, shapes (N, m) and (N, p), 1
        To identify from and to judge on: less the mean and over the spread of the part to identify from.
    packages : (float, float), %
        Best free run and best one step of any stable peer package on this row, not of the same one.
    sketches : (float, float), %
        The same with the plain numpy sketches (MOESP, and a finite-difference prediction error step) beside them.
    by_variance : bool
        Measured by VAF, rather than by NRMSE.
    """

    name: str
    order: int
    horizon: int
    own: Pair
    fresh: Pair
    packages: tuple[float, float]
    sketches: tuple[float, float]
    by_variance: bool = False


def cases() -> Iterator[Case]:
    """Yield the rows of the comparison; FileNotFoundError where the data are not here."""
    yield from _silverbox()
    yield from _compact_disc()
    yield from _evaporator()
    data = _daisy("steamgen")[:, 1:]
    own, fresh = _scaled(data, 4, slice(0, 4800), slice(4800, None))
    yield Case("steam generator n=9", 9, 15, own, fresh, (75.4, 94.1), (75.4, 94.1))


def _silverbox() -> Iterator[Case]:
    data = np.loadtxt(DATA / "silverbox/SNLS80mV.csv", delimiter=",")
    rows = (
        (2, 10_000, (83.7, 98.03), (83.7, 98.44)),
        (2, 77_000, (83.7, 98.05), (83.7, 98.05)),
        (7, 10_000, (85.7, 99.17), (85.7, 99.17)),
    )
    for order, samples, packages, sketches in rows:
        own, fresh = _scaled(data, 1, slice(40_700, 40_700 + samples), slice(118_000, 127_000))
        yield Case(f"silverbox n={order} N={samples}", order, 20, own, fresh, packages, sketches)


def _compact_disc() -> Iterator[Case]:
    data = _daisy("CD_player_arm")
    own, fresh = _scaled(data, 2, slice(0, 1024), slice(1024, None))
    yield Case("CD arm n=7", 7, 15, own, fresh, (63.2, 83.6), (72.1, 90.0))
    yield Case("CD arm n=12", 12, 20, own, fresh, (43.0, 79.4), (72.5, 79.4))
    own, fresh = _scaled(data, 2, slice(None), slice(None))
    yield Case("CD arm n=8, all, VAF", 8, 15, own, fresh, (86.0, 96.7), (95.5, 96.7), by_variance=True)


def _evaporator() -> Iterator[Case]:
    own, fresh = _scaled(_daisy("evaporator"), 3, slice(0, 3300), slice(3300, None))
    yield Case("evaporator n=4", 4, 10, own, fresh, (49.5, 78.1), (54.0, 78.1))
    yield Case("evaporator n=8", 8, 15, own, fresh, (60.3, 80.0), (60.3, 80.0))


def _daisy(name: str) -> np.ndarray:
    content = scipy.io.loadmat(DATA / f"daisy/{name}_dat.mat")
    (data,) = [value for key, value in content.items() if not key.startswith("_")]
    return np.asarray(data, float)


def _scaled(data: np.ndarray, inputs: int, own: slice, fresh: slice) -> tuple[Pair, Pair]:
    scaled = (data - data[own].mean(axis=0)) / data[own].std(axis=0)
    first, second = ((scaled[part, :inputs].copy(), scaled[part, inputs:].copy()) for part in (own, fresh))
    return first, second
