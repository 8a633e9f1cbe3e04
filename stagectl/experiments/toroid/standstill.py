"""What the deviation is to be: nothing; and no number while the robot is held, so that all controllers stand still."""

import numpy as np

from ctlblocks.block import Block, Port


class Standstill(Block):
    """Ask for no deviation, or for nothing at all while held: `holding` in; `reference` (m, 3) out.

    `ValvePosition` keeps its references and integrals where its reference is no number.
    """

    inputs = (Port("holding"),)
    outputs = (Port("reference", "m", 3),)

    def process(self, holding: np.ndarray, reference: np.ndarray) -> None:
        """Fill one frame."""
        for n in range(len(holding)):
            reference[n] = np.nan if holding[n, 0] > 0.5 else 0.0
