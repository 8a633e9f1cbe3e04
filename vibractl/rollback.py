"""Back to the best shot, as a whole, when the error has grown twice."""

from dataclasses import dataclass

import numpy as np

GROWN = 4.0
"""Times the best error that is more than chance."""
SLOWER = 0.5
"""Part of the gain that is left after each rollback."""


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
    """Keeps the best drive; `pace` is the part of the gain that is left.

    Single lines or bands are never taken back alone: what is wrong at one line may come from another's overtones.
    """

    def __init__(self) -> None:
        self.pace = 1.0
        self._best = np.inf
        self._last = np.inf
        self._expected = 0.0
        self._grown = 0
        self._shot = 0
        self._lines = np.zeros((0, 0), complex)

    def forget(self) -> None:
        """Let no earlier shot count any more: the vibrator is another one since."""
        self._best = self._last = np.inf
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
        if size < self._best:
            self._best, self._shot, self._lines, self._expected = size, shot, lines.copy(), expected
        self._grown = self._grown + 1 if size > max(self._last, self._expected) else 0
        self._last = size
        if self._grown < 2 or size < GROWN * self._best:
            return None
        self._grown, self._last = 0, np.inf
        self.pace *= SLOWER
        return Best(self._shot, self._lines, float(20 * np.log10(size / self._best)))
