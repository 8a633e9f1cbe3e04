"""Keep what the robot holds in the orientation in which it was touched off, as a Block."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot import kept_orientation_kernel as kernel


class KeptOrientation(Block):
    """Turn the robot's tool back by what the tracker sees it turned, with integral action.

    In: `orientation` (1, 4), a unit quaternion w x y z as seen, zeros where it is not, and `holding` (1 while the robot
    is held, so that nothing goes on).  Out: `rotation` (rad, 3) of the tool, in axes of the base, for
    `CartesianCorrection`.  While everything stands still at the beginning the orientation is averaged; that is the one
    which is kept.  How far it may be turned is the port's affair, which holds the robot beyond `limits.rotation`.

    Parameters
    ----------
    seconds : float, s, >= 0
        Time constant of the integral, much longer than the robot and tracker take; 0 for a robot that never turns.
    first, last : float, s, when averaging begins and ends

    Source
    ------
    Sörnmo 2015, sec. 2.3: orientation deviations are compensated by the macro manipulator alone, by eq. (2.6).

    Departs
    -------
    The thesis gives no law for it: here an integral, since the robot's lag and the tracker's noise leave nothing to a
    proportional part that is worth its noise.
    """

    inputs = (Port("orientation", "1", 4), Port("holding"))
    outputs = (Port("rotation", "rad", 3),)

    def __init__(self, seconds: float, first: float, last: float) -> None:
        self._seconds, self._times = seconds, (first, last)
        self._turn = np.zeros(1, kernel.TURN)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen."""
        for name in ("now", "wanted", "turn"):
            self._turn[name] = 0
        self._turn["first"], self._turn["last"] = (round(time * rate) for time in self._times)
        self._turn["gain"] = 1.0 / (self._seconds * rate) if self._seconds > 0 else 0.0

    def process(self, orientation: np.ndarray, holding: np.ndarray, rotation: np.ndarray) -> None:
        """Go on for one frame."""
        kernel.run(orientation, holding, rotation, self._turn)
