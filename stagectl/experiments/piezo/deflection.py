"""The deflection of the robot, as the laser sees it: taken off the reference, it is compensated."""

import math

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.config import Deflection
from stagectl.experiments.piezo import deflection_kernel as kernel


class DeflectionReference(Block):
    """Where the plate must be for the tool to be where it is wanted in a workpiece that a robot holds.

    The laser sees plate and robot together; what the position sensors saw of the plate at the same time is taken off
    it, and the rest, low-passed, off the wanted position.

    Ports, one wide an axis: `wanted`, `absolute` (laser), `position` (m) in; `reference` (m) out.

    Parameters
    ----------
    deflection : Deflection
    axes : int, >= 1

    Source
    ------
    Sörnmo 2015, section 2.2, "Optical tracking system": a laser sees the robot, the stage is to follow it.

    Departs
    -------
    The laser there saw the robot alone.
    """

    def __init__(self, deflection: Deflection, axes: int) -> None:
        self.inputs = tuple(Port(name, "m", axes) for name in ("wanted", "absolute", "position"))
        self.outputs = (Port("reference", "m", axes),)
        self._deflection = deflection
        self._axes = axes

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen."""
        self._pole = math.exp(-2.0 * math.pi * self._deflection.corner / rate)
        self._line = np.zeros((self._deflection.delay + 1, self._axes))
        self._at, self._robot = np.zeros(1, np.int64), np.zeros(self._axes)

    def process(self, wanted: np.ndarray, absolute: np.ndarray, position: np.ndarray, reference: np.ndarray) -> None:
        """Compensate one frame."""
        kernel.run(wanted, absolute, position, reference, self._line, self._robot, self._at, self._pole)
