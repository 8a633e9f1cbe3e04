"""Nothing happens: the surroundings of a stage that nobody pushes, of a tool in the air."""

import numpy as np

from ctlblocks.block import Block, Port


class Still(Block):
    """No force on plate or tool, and nothing that moves.

    Ports, three wide: `force` (N), `base` (m), `moment` (N m) out.
    """

    outputs = (Port("force", "N", 3), Port("base", "m", 3), Port("moment", "N m", 3))

    def process(self, force: np.ndarray, base: np.ndarray, moment: np.ndarray) -> None:
        """Fill one frame."""
        force.fill(0.0)
        base.fill(0.0)
        moment.fill(0.0)
