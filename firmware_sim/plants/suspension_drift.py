"""How a loudspeaker's suspension softens while it works, recovers at rest, and wanders with the weather."""

from dataclasses import dataclass

import numpy as np

HALF = 0.05
"""1: mean of (x / x_max)^2 at which half of the softening is there."""
FARTHEST = 0.2
"""1: of the logarithm of stiffness, that it wanders."""


@dataclass(frozen=True)
class Softening:
    """As it stands, none.

    Parameters
    ----------
    part : float, 1
        Of the stiffness, that is lost by hard work.
    seconds : float, s
        In which it is lost, and comes back.
    walk : float, 1/sqrt(minute)
        Standard deviation of a random walk of the stiffness after a minute.

    Source
    ------
    Klippel, Mechanical fatigue and load-induced aging of loudspeaker suspension, AES 131st Convention (2011): a loss
    that work makes; here only what comes back.
    """

    part: float = 0.0
    seconds: float = 60.0
    walk: float = 0.0


class SuspensionDrift:
    """The factor on each suspension's stiffness.

    Parameters
    ----------
    softening : Softening
    units : int
    seed : int
    """

    def __init__(self, softening: Softening, units: int, seed: int) -> None:
        self._softening = softening
        self._rng = np.random.default_rng(np.random.SeedSequence(seed).spawn(5)[4])
        self._work, self._walked, self._new = np.zeros(units), np.zeros(units), np.zeros(units)

    def step(self, seconds: float, worked: np.ndarray, factor: np.ndarray) -> None:
        """Go on by `seconds` s with a mean of (x / x_max)^2 of `worked`, and fill `factor`; shape (units,), 1."""
        it = self._softening
        keep = np.exp(-seconds / it.seconds)
        self._work *= keep
        self._new[:] = worked
        self._new *= 1 - keep
        self._work += self._new
        self._rng.standard_normal(out=self._new)
        self._new *= it.walk * np.sqrt(seconds / 60)
        self._walked += self._new
        np.clip(self._walked, -FARTHEST, FARTHEST, out=self._walked)
        np.add(self._work, HALF, out=self._new)
        np.divide(self._work, self._new, out=self._new)
        self._new *= -it.part
        self._new += 1.0
        np.exp(self._walked, out=factor)
        factor *= self._new
