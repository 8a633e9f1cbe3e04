"""Nothing happens: the surroundings of a stage that nobody pushes."""

import numpy as np

from ctlblocks.block import Block, Port


class Still(Block):
    """No force on the plate, and a robot that does not move.

    Ports, three wide: `force` (N), `base` (m) out.
    """

    outputs = (Port("force", "N", 3), Port("base", "m", 3))

    def process(self, force: np.ndarray, base: np.ndarray) -> None:
        """Fill one frame."""
        force.fill(0.0)
        base.fill(0.0)
