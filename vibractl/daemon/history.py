"""A table that grows by a row a shot, for days, and holds nothing but its numbers."""

import numpy as np


class History:
    """Rows of figures, in order.

    Parameters
    ----------
    width : int, figures in a row
    """

    def __init__(self, width: int) -> None:
        self._held, self._rows = np.zeros((64, width)), 0

    @property
    def rows(self) -> np.ndarray:
        """All rows so far, (rows, width); those that come later are not in it."""
        return self._held[: self._rows]

    def add(self, *figures: float) -> None:
        """Add a row."""
        if self._rows == len(self._held):
            self._held = np.concatenate([self._held, np.zeros_like(self._held)])
        self._held[self._rows] = figures
        self._rows += 1
