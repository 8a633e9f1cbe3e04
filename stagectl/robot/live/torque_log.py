"""The motors' torques of a trial: their line's samples kept, then brought to the times of the robot's reports."""

import numpy as np

from stagectl.robot.milling.alignment import on_grid
from stagectl.robot.program import TorqueSignals
from stagectl.wire.egm import RATE

_MORE = 5.0
"""s for which there is room beside the trial."""


class TorqueLog:
    """Keeps what comes over the signal line while a trial runs.

    Parameters
    ----------
    samples : int
        Of the trial, 250 a second.
    """

    def __init__(self, samples: int) -> None:
        self._kept, self._count = np.zeros((samples + round(_MORE * RATE), 13)), 0

    def keep(self, signals: TorqueSignals) -> None:
        """Keep what has come since the last time."""
        self._count += signals.samples.take(self._kept[self._count :])

    def torques(self, begun: float, samples: int, gap: float) -> np.ndarray:
        """Return the torques at a trial's samples, shape (samples, 6), N m.

        Parameters
        ----------
        begun : float, s
            Of the first sample, on the controller's clock, which is that of the signal line.
        samples : int
        gap : float, s
            Without a sample is refused.

        Raises
        ------
        ValueError : there are none, or a gap.
        """
        if not self._count:
            raise ValueError("no motor torques are heard")
        kept = self._kept[: self._count]
        return on_grid(kept[:, 0] - begun, kept[:, 7:], np.arange(samples) / RATE, gap, "the torque signals")
