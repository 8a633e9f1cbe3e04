"""A block that every rig needs: a gain."""

import math

import numpy as np

from ctlblocks.block import Block, Port


class Gain(Block):
    """Multiply by a number: `signal` in, `scaled` out.

    Parameters
    ----------
    factor : float, `scaled_unit` per `unit`, finite
    unit, scaled_unit : str
    width : int, channels, >= 1
    """

    def __init__(self, factor: float, unit: str = "1", scaled_unit: str = "1", width: int = 1) -> None:
        self.inputs = (Port("signal", unit, width),)
        self.outputs = (Port("scaled", scaled_unit, width),)
        self._factor = np.empty(())  # numpy would make an array of a Python float at every call
        self.change(factor)

    def process(self, signal: np.ndarray, scaled: np.ndarray) -> None:
        """Scale one frame."""
        np.multiply(signal, self._factor, scaled)

    def change(self, factor: float) -> None:
        """Take another factor (between ticks); one that is not finite is a ValueError."""
        if not math.isfinite(factor):
            raise ValueError(f"factor is {factor}, must be finite")
        self._factor.fill(factor)
