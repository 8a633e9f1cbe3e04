"""Linear chirps from rest to rest: what excites an axis."""

from dataclasses import dataclass

import numpy as np

from rigkit.fade import rise

FADE = 0.5
"""s, raised-cosine ends of a chirp."""


@dataclass(frozen=True)
class Chirp:
    """Rest, then a chirp: one batch of an experiment.

    Parameters
    ----------
    rate : float, samples/s
    settle, seconds : float, s
        Of rest, and of the chirp.
    start, stop : float, Hz
        Where the frequency begins and ends; it may fall.
    amplitude : float, the drive's unit
    """

    rate: float
    settle: float
    seconds: float
    start: float
    stop: float
    amplitude: float

    @property
    def rest(self) -> int:
        """Samples before the chirp."""
        return round(self.settle * self.rate)

    @property
    def samples(self) -> int:
        """Length with the rest before it."""
        return self.rest + round(self.seconds * self.rate)

    def drive(self) -> np.ndarray:
        """Return the deviation from rest, shape (samples, 1), the drive's unit."""
        time = np.arange(self.samples - self.rest) / self.rate
        turns = self.start * time + (self.stop - self.start) * time**2 / (2 * self.seconds)
        chirp = self.amplitude * np.sin(2 * np.pi * turns)
        fade = min(round(FADE * self.rate), len(chirp) // 4)
        up = rise(fade)
        chirp[:fade] *= up
        chirp[len(chirp) - fade :] *= up[::-1]
        return np.concatenate([np.zeros(self.rest), chirp])[:, np.newaxis]
