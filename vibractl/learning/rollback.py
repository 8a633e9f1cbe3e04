"""Back to the best shot, as a whole, when the error has grown twice."""

from collections import deque
from dataclasses import dataclass

import numpy as np

GROWN = 4.0
"""Times the best error that is more than chance."""
SLOWER = 0.5
"""Part of the gain that is left after each rollback."""
MEMORY = 10
"""Shots: a drive of longer ago was good for a vibrator that has drifted since.

On a vibrator whose error had grown by 2 % a shot, the drive of 25 shots before made it eight times as large.
"""


@dataclass(frozen=True)
class _Seen:
    """One of the last shots: its drive, the size of the error that it left, and of the one that was expected."""

    shot: int
    lines: np.ndarray
    size: float
    expected: float


@dataclass(frozen=True)
class Best:
    """The shot to go back to.

    Parameters
    ----------
    shot : int
    lines : complex array, shape (lines, inputs), V s
    growth_db : float, dB
        By how much the error had grown over that shot's.
    """

    shot: int
    lines: np.ndarray
    growth_db: float


class Rollback:
    """Keeps the drives of the last shots; `pace` is the part of the gain that is left.

    Single lines or bands are never taken back alone: what is wrong at one line may come from another's overtones.
    """

    def __init__(self) -> None:
        self.pace = 1.0
        self._seen: deque[_Seen] = deque(maxlen=MEMORY)
        self._last = np.inf
        self._grown = 0

    def forget(self) -> None:
        """Let no earlier shot count any more: the vibrator is another one since."""
        self._seen.clear()
        self._last = np.inf
        self._grown = 0

    def judged(self, shot: int, lines: np.ndarray, error: np.ndarray, expected: float) -> Best | None:
        """Look at the error that a drive left; return the best shot if it is time to go back to it.

        Parameters
        ----------
        shot : int
        lines : complex array, shape (lines, inputs), V s
        error : complex array, shape (lines, outputs), m/s^2 s
        expected : float, m/s^2 s
            How large its norm could be expected to be; growth up to what was expected of the best shot is no reason,
            but bounds that have widened because the error grew excuse nothing.
        """
        size = float(np.linalg.norm(error))
        self._seen.append(_Seen(shot, lines.copy(), size, expected))
        best = min(self._seen, key=lambda seen: seen.size)
        self._grown = self._grown + 1 if size > max(self._last, best.expected) else 0
        self._last = size
        if self._grown < 2 or size < GROWN * best.size:
            return None
        self._grown, self._last = 0, np.inf
        self.pace *= SLOWER
        return Best(best.shot, best.lines, float(20 * np.log10(size / best.size)))
