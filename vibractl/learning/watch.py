"""Looks after divergence: where the error grows though the model says that it should shrink."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibractl.config import Watch as Settings
from vibractl.learning.disturbance import smoothed
from vibractl.learning.law import Law

GROWN = 2.0
"""Times the least error that a band has had: less is chance."""
PATIENCE = 2
"""Shots in a row, near the limit; one more where there is `TIME`."""
TIME = 10 ** (-6 / 20)
"""Part of the limit below which learning is given one shot more to find out by itself."""
ALERT = 10 ** (-15 / 20)
"""Part of the limit below which a band's growth is of no concern yet."""
REACH = 3
"""Lines to each side over which a level is averaged before it is compared."""


@dataclass(frozen=True)
class Trouble:
    """A band that diverges.

    Parameters
    ----------
    centre : float, Hz
    test : str
        "level" for (6.20), "growth" for the earlier one.
    values : dict
        What decided it.
    """

    centre: float
    test: str
    values: dict[str, Any]


class Watch:
    """Judges every shot's error by bands of twice `half_width`.

    Parameters
    ----------
    law : Law
    settings : config.Watch
    limit : float, m/s^2 s
        Of the objective.

    Source
    ------
    Sörnmo 2015, eq. (6.20).

    Departs
    -------
    |Y| and |U| are taken re the limit and re the drive when the line was at its best, and a line is looked at only once
    it has been well below the limit: in absolute terms the test fires at notches, where |U| is large anyway, and on
    every first shot.  The test of growth is not in the text.
    """

    def __init__(self, law: Law, settings: Settings, limit: float) -> None:
        frequency = law.matrix.frequency
        low, high = settings.band
        self._settings, self._limit, self._frequency = settings, limit, frequency
        self._looked_at = (frequency >= low) & (frequency <= high) & (law.active > 0)
        self._block = np.where(self._looked_at, ((frequency - low) // (2 * settings.half_width)).astype(int), -1)
        blocks = int(self._block.max()) + 1
        self._best = np.full(blocks, np.inf)
        self._grown = np.zeros(blocks, dtype=int)
        self._least = np.full(len(frequency), np.inf)
        self._drive_then = np.zeros(len(frequency))

    def judged(self, drive: np.ndarray, error: np.ndarray, bound: np.ndarray) -> Trouble | None:
        """Look at a shot.

        Parameters
        ----------
        drive : complex array, shape (lines, inputs), V s
        error : complex array, shape (lines, outputs), m/s^2 s
        bound : array, shape (lines,), m/s^2 s
            How large the error was expected to be at most.

        Returns
        -------
        Trouble or None
        """
        size = np.sqrt(smoothed(np.abs(error) ** 2, REACH).max(axis=1))
        return self._by_growth(size, bound) or self._by_level(size, np.linalg.norm(drive, axis=1))

    def forgive(self, centre: float) -> None:
        """Start afresh in the band around `centre`, Hz."""
        near = np.abs(self._frequency - centre) <= 2 * self._settings.half_width
        self._least[near] = np.inf
        blocks = np.unique(self._block[near & self._looked_at])
        self._best[blocks], self._grown[blocks] = np.inf, 0

    def dismiss(self, lines: np.ndarray) -> None:
        """Look at some lines, bool (lines,), no more: they are frozen, and what is wrong elsewhere is to be seen."""
        self._looked_at = self._looked_at & ~lines
        self._block = np.where(lines, -1, self._block)

    def _by_growth(self, size: np.ndarray, bound: np.ndarray) -> Trouble | None:
        seen, block = self._looked_at, self._block[self._looked_at]
        blocks = len(self._best)
        power, expected = (np.bincount(block, value[seen] ** 2, blocks) for value in (size, bound))
        now, most = np.sqrt(power), np.sqrt(expected)
        loudest = np.zeros(blocks)
        np.maximum.at(loudest, block, size[seen])
        beyond = (now > most) & (now > GROWN * self._best) & (loudest > ALERT * self._limit)
        self._grown = np.where(beyond, self._grown + 1, 0)
        self._best = np.minimum(self._best, now)
        late = self._grown >= PATIENCE + (loudest < TIME * self._limit)
        if not late.any():
            return None
        worst = int(np.argmax(np.where(late, now, 0.0) / np.maximum(self._best, np.finfo(float).tiny)))
        line = int(np.argmax(np.where(self._block == worst, size, 0.0)))
        values = {"grown_db": _db(now[worst] / self._best[worst]), "over_bound_db": _db(now[worst] / most[worst])}
        return Trouble(float(self._frequency[line]), "growth", values)

    def _by_level(self, size: np.ndarray, drive: np.ndarray) -> Trouble | None:
        """(6.20)."""
        settings = self._settings
        growth = np.maximum(drive / np.maximum(self._drive_then, np.finfo(float).tiny) - 1.0, 0.0)
        level = settings.eta_1 * size / self._limit + settings.eta_2 * np.minimum(growth, 1e3) - settings.delta
        armed = self._looked_at & (self._least < ALERT * self._limit)
        better = size < self._least
        self._least = np.where(better, size, self._least)
        self._drive_then = np.where(better, drive, self._drive_then)
        worst = int(np.argmax(np.where(armed, level, -np.inf)))
        if not armed[worst] or not level[worst] > 0:
            return None
        values = {"level_db": _db(size[worst] / self._limit), "drive_db": _db(1.0 + growth[worst])}
        return Trouble(float(self._frequency[worst]), "level", values)


def _db(ratio: float) -> float:
    return round(float(20 * np.log10(max(ratio, 1e-12))), 2)
