"""The drive of a batch of tones: probe and preload glide from tone to tone, one side at a time carries the probe."""

from dataclasses import dataclass

import numpy as np

from rigkit.fade import rise

REST = 0.4
"""s more to settle at the start of a batch and at a change of side, where amplitudes and not only frequencies move."""
FADE = 0.1
"""s, raised-cosine ends of a batch and change of side."""
GLIDE = 0.05
"""s, raised-cosine step of the frequencies from one tone to the next; half the time to settle where that is shorter."""


@dataclass(frozen=True)
class Tones:
    """A batch: the same tones with the probe on one side after the other, up on the first, down on the second, ...

    Parameters
    ----------
    frequency : array, shape (tones,), Hz
        Of the probe.
    preload_frequency : array, shape (tones,), Hz
    settle : array, shape (tones,), s
        Before each tone is measured.
    tone : float, s
        Measured.
    preload, probe : float, V
        Amplitudes A and B.
    sides : int
    rate : float, samples/s
    step : int, samples
        Everything happens at multiples of it.
    """

    frequency: np.ndarray
    preload_frequency: np.ndarray
    settle: np.ndarray
    tone: float
    preload: float
    probe: float
    sides: int
    rate: float
    step: int

    @property
    def order(self) -> np.ndarray:
        """Which tone is played in each slot, shape (sides, tones)."""
        up = np.arange(len(self.frequency))
        return np.stack([up[:: 1 - 2 * (side % 2)] for side in range(self.sides)])

    @property
    def window(self) -> int:
        """Samples of a measured tone."""
        return int(self._samples(self.tone))

    @property
    def waits(self) -> np.ndarray:
        """Time before each slot's tone is measured, shape (sides, tones), s; longer where the probe comes from rest."""
        waits: np.ndarray = self.settle[self.order]
        waits[:, 0] += REST
        return waits

    @property
    def starts(self) -> np.ndarray:
        """First sample of each slot's measured tone, shape (sides, tones)."""
        waits = self._samples(self.waits)
        starts: np.ndarray = np.cumsum(waits.ravel() + self.window).reshape(waits.shape) - self.window
        return starts

    @property
    def samples(self) -> int:
        """Length of the drive."""
        return int(self.starts[-1, -1] + self.window + self._samples(FADE))

    def drive(self) -> np.ndarray:
        """Return the drive, shape (samples, sides), V, from rest to rest.

        Source
        ------
        Sörnmo 2015, eq. (6.2), (6.5).
        """
        probe = self.probe * np.sin(self._phase(self.frequency))
        preload = self.preload * np.sin(self._phase(self.preload_frequency))
        drive: np.ndarray = preload[:, None] + probe[:, None] * self._turns()
        fade = rise(int(self._samples(FADE)))[:, None]
        drive[: len(fade)] *= fade
        drive[len(drive) - len(fade) :] *= fade[::-1]
        return drive

    def _phase(self, frequency: np.ndarray) -> np.ndarray:
        """Integrate a frequency that holds within each tone and glides at the start of the wait before it."""
        slots, starts = self.order.ravel(), self.starts.ravel()
        ends = starts + self.window
        running = np.repeat(frequency[slots], np.diff(ends, prepend=0))
        running = np.append(running, np.full(self.samples - ends[-1], running[-1]))
        for end, start, last, following in zip(ends, starts[1:], slots, slots[1:], strict=False):
            glide = rise(int(min(self._samples(GLIDE), (start - end) // 2)))
            running[end : end + len(glide)] = frequency[last] + (frequency[following] - frequency[last]) * glide
        phase: np.ndarray = 2 * np.pi / self.rate * np.cumsum(running)
        return phase

    def _turns(self) -> np.ndarray:
        """Return how much of the probe each side carries at each sample, shape (samples, sides), 0 to 1."""
        turns = np.zeros((self.samples, self.sides))
        changes = np.concatenate([[0], self.starts[:-1, -1] + self.window, [self.samples]])
        swap = rise(int(self._samples(FADE)))
        for side in range(self.sides):
            turns[changes[side] : changes[side + 1], side] = 1.0
        for side, change in enumerate(changes[1:-1]):
            turns[change : change + len(swap), side + 1] = swap
            turns[change : change + len(swap), side] = swap[::-1]
        return turns

    def _samples(self, seconds: np.ndarray | float) -> np.ndarray:
        samples: np.ndarray = np.round(np.asarray(seconds) * self.rate / self.step).astype(int) * self.step
        return samples
