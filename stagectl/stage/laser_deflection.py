"""The deflection of the robot from laser readings of known age: taken off the reference, it is compensated."""

import math

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.stage import laser_deflection_kernel as kernel

OLDEST = 0.2
"""s for which positions are remembered."""


class LaserDeflection(Block):
    """Where the plate must be for the tool to be where it is wanted in a workpiece that a robot holds.

    Each new reading, less the position of the plate when it was taken, is the robot's deflection; it is held until the
    next, low-passed, and taken off the wanted position.  As both are of the same instant, a slow laser makes no loop
    around the stage.

    Ports, one wide an axis: `wanted`, `laser` (m), `age` (s, of the reading), `position` (m) in; `reference` (m) out.

    Parameters
    ----------
    corner : float, Hz, of a first-order low-pass
    ramp : float, s, in which it is faded in and out
    axes : int, >= 1

    Source
    ------
    Sörnmo 2015, section 2.2, "Optical tracking system": a laser sees the robot, the stage is to follow it.

    Departs
    -------
    The laser there saw the robot alone.
    """

    def __init__(self, corner: float, ramp: float, axes: int) -> None:
        self.inputs = (
            Port("wanted", "m", axes),
            Port("laser", "m", axes),
            Port("age", "s", axes),
            Port("position", "m", axes),
        )
        self.outputs = (Port("reference", "m", axes),)
        self.corner, self._ramp, self._axes = corner, ramp, axes

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen; nothing is compensated until `fade_in`."""
        self._rate = rate
        self._line = np.zeros((round(OLDEST * rate), self._axes))
        self._robot, self._age = np.zeros((2, self._axes)), np.zeros(self._axes)
        self._state = np.zeros(1, kernel.FADE)
        self._state["rate"] = rate
        self.change(self.corner)

    def process(
        self, wanted: np.ndarray, laser: np.ndarray, age: np.ndarray, position: np.ndarray, reference: np.ndarray
    ) -> None:
        """Compensate one frame."""
        seen = laser, age, position
        kernel.run(wanted, seen, reference, self._line, self._robot, self._age, self._state)

    def change(self, corner: float) -> None:
        """Take another corner frequency, Hz (between ticks)."""
        self.corner = corner
        self._state["pole"] = math.exp(-2.0 * math.pi * corner / self._rate)

    def fade_in(self) -> None:
        """Begin to compensate, along a raised cosine (between ticks)."""
        self._state["step"] = 1.0 / (self._ramp * self._rate)

    def fade_out(self) -> None:
        """Cease to compensate, along a raised cosine (between ticks)."""
        self._state["step"] = -1.0 / (self._ramp * self._rate)
