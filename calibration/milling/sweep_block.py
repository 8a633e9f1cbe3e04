"""A planned sweep as a Block: the arm is led to the first pose, then along the path, then held."""

import numpy as np

from ctlblocks.block import Block, Port


class Sweep(Block):
    """Lead an arm along a path; it begins where the arm is measured to be, and holds when a fault is told.

    Ports: `angle` (rad, 6) of the motors and `fault` (1 for yes) in; `reference` (rad, 6), `soft` and `clamp` (always
    off), and `step` (from 1; 0 before the path begins and after it has ended) out.

    Parameters
    ----------
    path : array, shape (samples, 6), rad
    step : array, shape (samples,)
        What each sample of the path belongs to, from 1.
    approach : float, rad/s
        Of the fastest joint on the way to the path's first sample.
    """

    inputs = (Port("angle", "rad", 6), Port("fault"))
    outputs = (Port("reference", "rad", 6), Port("soft"), Port("clamp"), Port("step"))

    def __init__(self, path: np.ndarray, step: np.ndarray, approach: float) -> None:
        self._path, self._steps, self._approach = path, step, approach

    def prepare(self, rate: float, frames: int) -> None:
        """Begin anew."""
        self._at, self._reference, self._most = -1, np.full(6, np.nan), self._approach / rate
        self.is_faulty = self._is_held = False

    def hold(self) -> None:
        """Stay where it is from the next sample on (between ticks)."""
        self._is_held = True

    @property
    def is_there(self) -> bool:
        """Whether the path has begun."""
        return self._at >= 0

    @property
    def done(self) -> bool:
        """Whether the path has ended."""
        return self._at >= len(self._path)

    def process(
        self,
        angle: np.ndarray,
        fault: np.ndarray,
        reference: np.ndarray,
        soft: np.ndarray,
        clamp: np.ndarray,
        step: np.ndarray,
    ) -> None:
        """Fill one frame."""
        soft.fill(0.0)
        clamp.fill(0.0)
        for n in range(len(angle)):
            if np.isnan(self._reference[0]):
                self._reference[:] = angle[n]
            self.is_faulty = self.is_faulty or fault[n, 0] >= 1.0 or bool(np.isnan(angle[n]).any())
            step[n, 0] = 0.0
            if self.is_faulty or self._is_held:
                pass
            elif self._at < 0:
                self._come_near()
            elif not self.done:
                self._reference[:] = self._path[self._at]
                step[n, 0] = self._steps[self._at]
                self._at += 1
            reference[n] = self._reference

    def _come_near(self) -> None:
        away = self._path[0] - self._reference
        farthest = float(np.abs(away).max())
        if farthest <= self._most:
            self._at = 0
        else:
            self._reference += away * (self._most / farthest)
