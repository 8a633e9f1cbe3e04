"""Where the tool is beside where it is wanted in the workpiece, from the tracker and the stage's own sensors."""

from collections.abc import Sequence

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.experiments.toroid import relative_position_kernel as kernel


class RelativePosition(Block):
    """The tool's deviation from its path: what is slow from the tracker, what is quick from the stage's own sensors.

    The tracker is noisy and late.  A quick sensor sees a part of what it sees: of the plate its position, or, with a
    laser, the plate and the robot together.  That part is taken off the tracker's at the time the tracker saw it, the
    rest is low-passed (twice, first order), and the part comes back as it is now.  While everything stands still at the
    beginning the offsets are averaged, and taken off from then on; until that is done the deviation is zero.

    Ports, three wide: `spindle`, `workpiece` (as seen), `wanted` (of the tool in the workpiece), `position` (of the
    plate), `absolute` (laser) in; `deviation` out, m.

    Parameters
    ----------
    corner : three floats, Hz, > 0
        Of each low-pass, an axis each.
    by_laser : three bools
        Which axes have a laser.
    delay : float, s, >= 0, by which the tracker comes later than the quick sensors
    first, last : float, s, when averaging begins and ends
    """

    inputs = tuple(Port(name, "m", 3) for name in ("spindle", "workpiece", "wanted", "position", "absolute"))
    outputs = (Port("deviation", "m", 3),)

    def __init__(
        self, corner: Sequence[float], by_laser: Sequence[bool], delay: float, first: float, last: float
    ) -> None:
        self._corner, self._delay, self._times = corner, delay, (first, last)
        self._axes, self._clock = np.zeros(3, kernel.AXIS), np.zeros(1, kernel.CLOCK)
        self._axes["by_laser"] = by_laser

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen."""
        self._line = np.zeros((max(1, round(self._delay * rate)), 3))
        self._axes["pole"] = np.exp(-2.0 * np.pi * np.array(self._corner) / rate)
        for name in ("zero", "quick_zero", "smooth", "smoother"):
            self._axes[name] = 0.0
        self._clock[0] = 0, *(round(time * rate) for time in self._times)

    def process(
        self,
        spindle: np.ndarray,
        workpiece: np.ndarray,
        wanted: np.ndarray,
        position: np.ndarray,
        absolute: np.ndarray,
        deviation: np.ndarray,
    ) -> None:
        """Go on for one frame."""
        seen, quick = (spindle, workpiece), (position, absolute)
        kernel.run(seen, quick, wanted, deviation, self._line, self._axes, self._clock)
