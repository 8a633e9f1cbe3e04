"""What was learned of one milling type: durations and force deviations, without outliers, old ones fading."""

import math
from dataclasses import dataclass, field

import numpy as np

NEARLY_NOTHING = 1e-6
"""s per cell, of a type never milled in auto-training."""


@dataclass(frozen=True)
class Memory:
    """How samples are weighed.

    Parameters
    ----------
    window : int, samples
        Older ones count no more.
    taper : float, 1, 0 to 1
        The share of the window, its older end, over which weights fade along a cosine.
    outlier : float, 1
        Samples further from the mean than so many standard deviations are left out,
    many : int, samples
        once there are more than so many.

    Source
    ------
    Sörnmo 2015, sec. 7.2, "Acquisition of Learning Data", which gives no figures.
    """

    window: int = 30
    taper: float = 0.5
    outlier: float = 2.0
    many: int = 5

    def __post_init__(self) -> None:
        """Refuse what weighs nothing."""
        if not self.window >= 1:
            raise ValueError(f"window is {self.window} samples, must be >= 1")
        if not 0.0 <= self.taper <= 1.0:
            raise ValueError(f"taper is {self.taper}, must be 0 to 1")
        if not self.outlier > 1.0:
            raise ValueError(f"outlier is {self.outlier} standard deviations, must be > 1")
        if not self.many >= 2:
            raise ValueError(f"many is {self.many} samples, must be >= 2")

    def weights(self, count: int) -> np.ndarray:
        """Return the weight of each of `count` samples, the newest last; shape (count,), 1."""
        age = np.arange(count - 1, -1, -1) / self.window
        fading = np.clip((age - (1.0 - self.taper)) / self.taper, 0.0, 1.0) if self.taper > 0.0 else 1.0 * (age >= 1.0)
        return np.asarray(np.where(age < 1.0, 0.5 + 0.5 * np.cos(np.pi * fading), 0.0))


@dataclass
class TrainingSet:
    """The set S of one milling type.

    Parameters
    ----------
    memory : Memory
    rates : list of float, s per cell
        Newest last.
    forces : list of float, N
        Standard deviations of the force within a segment, as many; NaN where none was measured.
    """

    memory: Memory
    rates: list[float] = field(default_factory=list)
    forces: list[float] = field(default_factory=list)

    def add(self, rate: float, force: float = math.nan) -> None:
        """Take in a finished segment: its rate, s per cell, and its force's deviation, N."""
        self.rates.append(rate)
        self.forces.append(force)

    @property
    def count(self) -> int:
        """Samples that are left when outliers are out."""
        return int(self._kept().sum())

    def mean(self) -> float:
        """Return the weighted mean of the rates, s per cell; NaN of an empty set."""
        return self._moments(np.array(self.rates))[0]

    def deviation(self) -> float:
        """Return the weighted standard deviation of the rates, s per cell; NaN of an empty set."""
        return self._moments(np.array(self.rates))[1]

    def force(self) -> float:
        """Return the weighted mean of the force's deviations, N; NaN where none was measured."""
        return self._moments(np.array(self.forces))[0]

    def _kept(self) -> np.ndarray:
        rates = np.array(self.rates)
        if len(rates) <= self.memory.many:
            return np.ones(len(rates), bool)
        return np.asarray(np.abs(rates - rates.mean()) <= self.memory.outlier * rates.std(ddof=1))

    def _moments(self, values: np.ndarray) -> tuple[float, float]:
        weights = self.memory.weights(len(values)) * self._kept() * np.isfinite(values)
        whole = weights.sum()
        if not whole > 0.0:
            return math.nan, math.nan
        values = np.where(weights > 0.0, values, 0.0)
        mean = float(weights @ values / whole)
        effective = whole - (weights @ weights) / whole  # n - 1 for equal weights
        spread = float(weights @ np.where(weights > 0.0, values - mean, 0.0) ** 2)
        return mean, math.sqrt(spread / effective) if effective > 0.0 else 0.0
