"""Slower on lines where learning has made the error larger."""

import numpy as np

GROWN = 1.02
"""Times the power of the error before that is more than the same."""
SLOWER, FASTER = 0.5, 1.1
"""By how much a line's pace changes after a shot whose error has grown there, and after any other."""
SLOWEST = 0.05
"""A line is never given up."""


class Pace:
    """Follows the error of each line from shot to shot; `part` is the part of the gain that is left to each.

    A line that is learned with a G that is wrong by more than its own size grows worse with every shot, long before the
    error as a whole does.

    Parameters
    ----------
    lines : int
    """

    def __init__(self, lines: int) -> None:
        self.part = np.ones(lines)
        self._before: np.ndarray | None = None

    def forget(self) -> None:
        """Begin anew: what was learned at another level says nothing."""
        self.part, self._before = np.ones_like(self.part), None

    def take(
        self,
        power: np.ndarray,
        noise: np.ndarray,
        drift: np.ndarray | float = 0.0,
        is_doubtful: np.ndarray | bool = True,
    ) -> None:
        """Take the error of a shot.

        Parameters
        ----------
        power : array, shape (lines,), (m/s^2 s)^2
            Of the error, averaged over the lines around each.
        noise : array, shape (lines,), (m/s^2 s)^2
            By how much it may have grown by chance.
        drift : array, shape (lines,), or float, (m/s^2 s)^2
            Power of what a plant that drifts adds to the error in a shot.
        is_doubtful : array, shape (lines,), or bool
            Where learning may have made it grow.

        Notes
        -----
        What the plant has made grow is to be learned: a line that waits for it grows further.
        """
        if self._before is not None:
            may_be = GROWN * (np.sqrt(self._before) + np.sqrt(drift)) ** 2 + noise
            has_grown = is_doubtful & (power > may_be)
            self.part = np.clip(self.part * np.where(has_grown, SLOWER, FASTER), SLOWEST, 1.0)
        self._before = power
