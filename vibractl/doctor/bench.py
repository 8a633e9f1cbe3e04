"""The audio line as a measuring instrument: any signal on the loopback cable, and recordings taken as they come."""

import math
from collections.abc import Callable

import numpy as np

from vibractl.audio import Line
from vibractl.capture import Capture, Discarded, spoiled
from vibractl.config import RigConfig
from vibractl.proof import LARGEST_ROUND_TRIP, Emission, Evidence


class _Unproved:
    """No proof of alignment: whether the recording lies where it should is what is to be found out."""

    def __init__(self, config: RigConfig) -> None:
        self.whole, self.first = 0, 0.0
        self.timing = np.zeros(0)
        self._silence = np.zeros((config.audio.blocksize, len(config.audio.drive_channels)))

    def probe(self) -> Emission:
        """Play one block of nothing."""
        return Emission(self._silence, np.zeros(0), 0, len(self._silence))

    def learn(self, response: np.ndarray, loopback: np.ndarray) -> str:
        """Take any recording: responses, shape (frames, responses), m/s^2; loopback, shape (frames,), full scale."""
        del response, loopback
        return ""

    def emission(self, drive: np.ndarray) -> Emission:
        """Play a drive, shape (samples, drives), V, and what is to go over the cable."""
        return Emission(drive, self.timing, 0, len(drive))

    def judge(self, emission: Emission, response: np.ndarray, loopback: np.ndarray) -> Evidence:
        """Find no fault with responses, shape (frames, responses), and loopback, shape (frames,)."""
        del emission, response, loopback
        return Evidence(math.nan, 0.0, math.nan, "")


class Bench(Line):
    """A `Line` that proves nothing and lets its owner choose what goes over the loopback cable.

    The guard, its limits and the discarding of spoiled recordings are those of every line.  Nothing is aligned: row 0
    of a recording is the first sample emitted, and what comes back lies up to the round trip later.

    Parameters
    ----------
    config : RigConfig
    seconds : float, s
        Longest signal that will be played.
    on_discard : callable(Discarded)
    """

    def __init__(self, config: RigConfig, seconds: float, on_discard: Callable[[Discarded], None]) -> None:
        super().__init__(config, seconds=seconds + LARGEST_ROUND_TRIP, on_discard=on_discard)
        self._proof = self._unproved = _Unproved(config)
        self._tail = round(LARGEST_ROUND_TRIP * config.audio.rate)

    def _spoiled(self, capture: Capture) -> str:
        return spoiled(capture, self._audio)  # what stands still is for the doctor to see

    def record(self, drive: np.ndarray, timing: np.ndarray) -> Capture:
        """Play a drive and a signal on the cable, and record until half a second after their end.

        Parameters
        ----------
        drive : array, shape (samples, drives), V
        timing : array, shape (at most samples,), full scale

        Returns
        -------
        Capture

        Raises
        ------
        As `Line.emit`.
        """
        self._unproved.timing = timing
        return self.emit(np.concatenate((drive, np.zeros((self._tail, drive.shape[1])))))
