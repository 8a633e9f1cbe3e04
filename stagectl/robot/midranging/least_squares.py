"""Recursive least squares inside a loop: how it forgets, and when it does not listen."""

import math
from dataclasses import dataclass

import numpy as np

from stagectl.robot.midranging.axis_record import SIZE, SQUARES

KEEP = 0.999
"""Of the mean squares of residual and activity, an update."""
DRIFT, ALARM = 3.0, 50.0
"""Of the alarm: what it forgets a sample, and where it rings, in squared standard deviations of the residual."""


@dataclass(frozen=True)
class LeastSquares:
    """The estimator of one loop.

    Parameters
    ----------
    forgetting : float, > 0 to 1
        For each sample that is listened to.
    noise : float, m, > 0
        Standard deviation of the sensor's noise; at least its resolution.
    deviation : float, 1, > 0
        Standard deviation of each parameter before anything is seen, and bound of the covariance ever after.
    smoothing : float, s, >= 0
        Time constant of the low-pass before the regressors; that of the loop makes the noise of the sensor white where
        it counts.
    gate : float, >= 0
        Nothing is listened to while the loop's smoothed input is within so many `noise` of its own mean over
        `smoothing`; 0 listens always.
    alarm : bool
        Whether residuals too large for `noise` make it start anew.

    Raises
    ------
    ValueError : a value outside its range, or a gate without smoothing.

    Source
    ------
    Sörnmo 2015, eq. (3.4).

    Departs
    -------
    Smoothing, gate, bound and alarm.  A sample that is not listened to forgets nothing.
    """

    forgetting: float = 0.999
    noise: float = 1e-6
    deviation: float = 0.3
    smoothing: float = 0.0
    gate: float = 0.0
    alarm: bool = False

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        if not 0.0 < self.forgetting <= 1.0:
            raise ValueError(f"forgetting is {self.forgetting}, must be > 0 and at most 1")
        for name, unit in (("noise", " m"), ("deviation", "")):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}{unit}, must be finite and > 0")
        for name, unit in (("smoothing", " s"), ("gate", "")):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}{unit}, must be finite and >= 0")
        if self.gate and not self.smoothing:
            raise ValueError(f"gate is {self.gate}, must be 0 where smoothing is 0 s: the gate needs its mean")

    def packed(self, estimate: np.ndarray, rate: float) -> np.void:
        """Return the estimator at its beginning, as the kernel reads it.

        Parameters
        ----------
        estimate : array, shape (2 order,), 1
        rate : float, samples/s
        """
        pole = math.exp(-1.0 / (self.smoothing * rate)) if self.smoothing else 0.0
        residual = (1.0 - pole) * self.noise
        record: np.void = np.zeros(1, SQUARES)[0]
        record["forgetting"], record["pole"], record["variance"] = self.forgetting, pole, residual**2
        record["start"], record["gate"] = (self.deviation / residual) ** 2, self.gate * self.noise
        record["drift"], record["limit"] = DRIFT, ALARM if self.alarm else math.inf
        record["keep"], record["usual"] = KEEP, math.inf
        record["estimate"][: len(estimate)] = estimate
        record["factors"] = record["start"] * np.eye(SIZE)
        return record
