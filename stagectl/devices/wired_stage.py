"""The stage behind its link, in a graph that ticks with the robot: what it shows, and where it is to be."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.link.smoothed_line import SmoothedLine
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import AXES


class WiredPlate(Block):
    """Hold the stage's newest samples: `position`, `extension` (m, 3) out, and `absolute`, since no laser is there.

    Parameters
    ----------
    link : StageLink
    middle : float, m
        Of its travel: zero on the wire.
    """

    outputs = (Port("position", "m", 3), Port("extension", "m", 3), Port("absolute", "m", 3))

    def __init__(self, link: StageLink, middle: float) -> None:
        self.link, self._middle = link, middle
        (_, self._position), (_, self._extension) = link.signal("position"), link.signal("extension")

    def process(self, position: np.ndarray, extension: np.ndarray, absolute: np.ndarray) -> None:
        """Fill one frame."""
        position[:], extension[:], absolute[:] = self._position, self._extension, 0.0
        position += self._middle


class WiredPlateReference(Block):
    """Where the plate is to be, behind a first-order low-pass: `reference` (m, 3) in.

    Parameters
    ----------
    link : StageLink
    middle : float, m
        Of its travel: zero on the wire.
    smoothing : float, s, > 0
        Time constant of the low-pass.
    """

    inputs = (Port("reference", "m", 3),)

    def __init__(self, link: StageLink, middle: float, smoothing: float) -> None:
        self._link, self._middle, self._smoothing = link, middle, smoothing

    def prepare(self, rate: float, frames: int) -> None:
        """Begin at mid-travel."""
        self._line, self._wanted = SmoothedLine(self._smoothing), np.zeros(len(AXES))

    def process(self, reference: np.ndarray) -> None:
        """Hand over the newest sample; nothing once the link has latched."""
        if not self._link.reason:
            np.subtract(reference[-1], self._middle, out=self._wanted)
            self._link.references.put(self._line.to(self._wanted))
