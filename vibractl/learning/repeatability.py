"""How much a response changes from shot to shot by itself: what the drive's change does not explain."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from vibractl.decibels import FAINT, decibels
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.disturbance import smoothed
from vibractl.learning.shot import Shot

KEPT = 6
"""Changes from shot to shot of which each line's median counts; with fewer than half of them nothing is said."""
REACH = 2
"""Lines to each side over which their power is averaged: a mode that moves is no narrower."""
DISTINCT = 2.0
"""Times the noise's power, from which on a change is none of the noise's own: chance alone reaches 1.7 somewhere."""


@dataclass(frozen=True)
class Floor:
    """What a model does not explain of the change from shot to shot, on the line where that is most.

    Parameters
    ----------
    change : float, dB re the limit of a line
        Root of the median power, less noise.
    frequency : float, Hz
    explained : float, dB re the limit of a line
        What the drive's change makes there, as the model has it: where that is more, a model that is wrong leaves as
        much.
    """

    change: float
    frequency: float
    explained: float


class Repeatability:
    """Follows what G does not explain of the change between two shots.

    On lines that are learned no drive can make an error smaller than that for long: it is the floor of a run.

    Parameters
    ----------
    algorithm : Algorithm
    judged : bool array, shape (lines,)
        Lines that are learned and for which the limit holds.
    limit : float, m/s^2 s
        Of a line.
    """

    def __init__(self, algorithm: Algorithm, judged: np.ndarray, limit: float) -> None:
        self._algorithm, self._judged, self._limit = algorithm, judged, limit
        self._active = algorithm.law.active > 0
        self._before: Shot | None = None
        self._changes: deque[tuple[np.ndarray, ...]] = deque(maxlen=KEPT)

    def take(self, shot: Shot, counts: bool = True) -> float:
        """Take a shot; return what is not explained of the change since the one before, dB re the response.

        NaN for the first shot.  One that was for something else than to learn does not count for the floor.
        """
        before, self._before = self._before, shot
        if before is None:
            return float("nan")
        explained = self._algorithm.belief.explained(shot.drive - before.drive)
        left = shot.response - before.response - explained
        if counts:
            powers = np.abs(left) ** 2, shot.noise + before.noise, np.abs(explained) ** 2
            self._changes.append(tuple(smoothed(power, REACH)[self._judged] for power in powers))
        active = left[self._active]
        size = max(float(np.linalg.norm(shot.response[self._active])), FAINT)
        return float(decibels(float(np.linalg.norm(active)) / size))

    @property
    def floor(self) -> Floor | None:
        """What is not explained of the change from shot to shot, where that is most.

        None while too few shots are known, or where noise hides it on every line.
        """
        if 2 * len(self._changes) < KEPT or not self._judged.any():
            return None
        changed, noise, explained = np.median(np.array(self._changes), axis=0)
        power = np.where(changed > DISTINCT * noise, changed - noise, 0.0).max(axis=1)
        line = int(np.argmax(power))
        if not power[line] > 0:
            return None
        frequency = self._algorithm.law.matrix.frequency[self._judged]
        change, drive = (float(decibels(np.sqrt(each) / self._limit)) for each in (power[line], explained[line].max()))
        return Floor(change, float(frequency[line]), drive)
