"""The phase before control, in which both loops are excited and their models and dead times are estimated."""

import math
from dataclasses import dataclass

import numpy as np

from stagectl.robot.midranging.axis_record import BANK, LINE


@dataclass(frozen=True)
class Estimation:
    """The phase before control, in which square waves excite both loops and the estimators alone work.

    Parameters
    ----------
    seconds : float, s, >= 0
        It takes at least so long; at 0 control begins at once.
    accuracy : float, 1, > 0
        It goes on until the models' own outputs are off by less than this share of the measured ones (rms over about
        a period of the slow wave), noise apart, or for `half_periods`.
    acceptable : float, 1, > 0
        Up to this share control begins nevertheless; beyond it valve position control takes over at once.
    half_periods : float, > 0
        Of the slow wave, at most.
    latest : float, 1, 0 to 1
        Dead times up to this share of a loop's time constant are tried; 0: the one that the pair is told.
    fast_amplitude, slow_amplitude : float, m, > 0
    fast_half_period, slow_half_period : float, s, > 0

    Raises
    ------
    ValueError : a value outside its range, by name.
    """

    seconds: float = 4.0
    accuracy: float = 0.05
    acceptable: float = 0.4
    half_periods: float = 7.0
    latest: float = 0.4
    fast_amplitude: float = 0.5e-3
    slow_amplitude: float = 0.5e-3
    fast_half_period: float = 0.5
    slow_half_period: float = 1.0

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        if not 0.0 <= self.seconds < math.inf:
            raise ValueError(f"seconds is {self.seconds} s, must be finite and >= 0")
        for name, unit in (("fast_amplitude", " m"), ("slow_amplitude", " m"), ("fast_half_period", " s"),
                           ("slow_half_period", " s"), ("accuracy", ""),
                           ("acceptable", ""), ("half_periods", "")):  # fmt: skip
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}{unit}, must be finite and > 0")
        if not 0.0 <= self.latest <= 1.0:
            raise ValueError(f"latest is {self.latest}, must be 0 to 1")

    def delays(self, told: float, time: float, rate: float) -> np.ndarray:
        """Return the dead times that are tried, ascending, shape (candidates,), samples.

        Parameters
        ----------
        told, time : float, s
            Dead time that is believed in, and time constant of the loop.
        rate : float, samples/s
        """
        if self.latest == 0.0:
            return np.array([round(told * rate)])
        most = max(self.latest * time, told) * rate
        tried: np.ndarray = np.unique(np.round(np.linspace(0.0, min(most, LINE - 1.0), BANK))).astype(int)
        return tried
