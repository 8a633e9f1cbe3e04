"""How the modes of a structure move as time passes: at random, steadily, or all at once."""

from dataclasses import dataclass

import numpy as np

FARTHEST = 0.05
"""1: a random walk is reflected where it has moved a mode by this part of its frequency."""


@dataclass(frozen=True)
class Drift:
    """What becomes of the modal frequencies; any of three, or none.

    Parameters
    ----------
    walk : float, 1/sqrt(minute)
        Standard deviation of each mode's relative change in a minute.
    trend : float, 1
        Relative change of all modes together over `trend_seconds`; then they stay.
    trend_seconds : float, s
    jump_mode : int
        Which oscillation jumps, counted from 0 in order of frequency.
    jump_widths : float, half-power bandwidths
        By how many of its own, 2 zeta f.
    jump_at : float, s
    """

    walk: float = 0.0
    trend: float = 0.0
    trend_seconds: float = 600.0
    jump_mode: int = 0
    jump_widths: float = 0.0
    jump_at: float = 60.0

    @property
    def is_still(self) -> bool:
        """Whether nothing ever moves."""
        return self.walk == self.trend == self.jump_widths == 0.0


class ModeDrift:
    """The factor by which each pole has moved.

    Parameters
    ----------
    drift : Drift
    poles : complex array, shape (modes,), rad/s
        Those of a structure; real ones stay where they are.
    seed : int
    """

    def __init__(self, drift: Drift, poles: np.ndarray, seed: int) -> None:
        self._drift = drift
        self._rng = np.random.default_rng(np.random.SeedSequence(seed).spawn(4)[3])
        self._rings = poles.imag > 0
        self._walked, self._new = np.zeros(len(poles)), np.zeros(len(poles))
        self._seconds = 0.0
        self._jumps = int(np.flatnonzero(self._rings)[drift.jump_mode])
        pole = poles[self._jumps]
        self._far = drift.jump_widths * 2 * -pole.real / np.abs(pole)

    def step(self, seconds: float, factor: np.ndarray) -> None:
        """Fill `factor`, shape (modes,) 1, with how far the poles have moved, and go on by `seconds` s."""
        drift, walked = self._drift, self._walked
        if drift.walk:
            self._rng.standard_normal(out=self._new)
            self._new *= drift.walk * np.sqrt(seconds / 60)
            walked += self._new
            np.clip(walked, -2 * FARTHEST - walked, 2 * FARTHEST - walked, out=walked)  # reflected at either end
        factor[:] = walked
        factor += 1.0
        factor *= 1.0 + drift.trend * min(self._seconds / drift.trend_seconds, 1.0)
        if drift.jump_widths and self._seconds >= drift.jump_at:
            factor[self._jumps] *= 1.0 + self._far
        factor[~self._rings] = 1.0
        self._seconds += seconds
