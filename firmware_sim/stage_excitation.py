"""What stands between the stage's loops and its guard: the loops' request or, for identification, an excitation."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.wire.messages import AXES, Drive


class Excitation(Block):
    """Let the loops' request through; or excite one axis while the others rest.

    Ports, three wide: `request` (V, of both loops) and `inner` (V, of the inner loops alone) in; `voltage` (V) out.

    Parameters
    ----------
    rest : float, V
    """

    inputs = (Port("request", "V", len(AXES)), Port("inner", "V", len(AXES)))
    outputs = (Port("voltage", "V", len(AXES)),)

    def __init__(self, rest: float) -> None:
        self.rest = rest
        self.drive: Drive | None = None
        self.axis = 0
        self.deviation = 0.0

    def process(self, request: np.ndarray, inner: np.ndarray, voltage: np.ndarray) -> None:
        """Pass on one frame; of an axis excited by its voltage, `rest` and `deviation` (V)."""
        if self.drive is None:
            voltage[:] = request
            return
        voltage.fill(self.rest)
        if self.drive is Drive.VOLTAGE:
            voltage[:, self.axis] += self.deviation
        else:
            voltage[:, self.axis] = inner[:, self.axis]
