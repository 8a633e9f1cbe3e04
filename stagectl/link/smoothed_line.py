"""References for the stage sample by sample, from one that comes at the robot's rate: a step would shake it."""

import numpy as np

from stagectl.wire.messages import AXES, RATE
from stagectl.wire.robot import RATE as ROBOT_RATE

PER_TICK = round(RATE / ROBOT_RATE)
"""Samples of the stage in one of the robot's."""


class SmoothedLine:
    """A first-order low-pass, begun at mid-travel.

    Parameters
    ----------
    smoothing : float, s, > 0
        Time constant.
    """

    def __init__(self, smoothing: float) -> None:
        self._line, self._last = np.zeros((PER_TICK, len(AXES))), np.zeros(len(AXES))
        left = np.arange(1.0, PER_TICK + 1) / (RATE * smoothing)
        self._part = np.exp(-left)[:, np.newaxis]
        self._step = np.zeros(len(AXES))

    def to(self, wanted: np.ndarray) -> np.ndarray:
        """Return the samples until the next reference, shape (PER_TICK, 3), m; the same array each time.

        Parameters
        ----------
        wanted : array, shape (3,), m
        """
        np.subtract(self._last, wanted, out=self._step)
        np.multiply(self._part, self._step, out=self._line)
        self._line += wanted
        self._last[:] = self._line[-1]
        return self._line
