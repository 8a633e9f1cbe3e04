"""Proof of alignment by a cable: chirps from an output to an input for as long as the drive lasts."""

import math

import numpy as np

from vibractl import alignment
from vibractl.config import Audio
from vibractl.proof import LARGEST_ROUND_TRIP, Emission, Evidence, evidence

LEVEL = 0.1
"""of full scale: 20 dB down, so that crosstalk stays far below the responses."""
TRUST = 0.995
"""Least quality of each chirp: 20 dB of noise, or 10 samples of 1024 lost, is too much."""


class Loopback:
    """A cable from an output to an input, with a chirp after a chirp for as long as the drive lasts.

    Every sample of a shot lies under some chirp, so a lost block or a slip in mid-shot shows, wherever it is.

    Parameters
    ----------
    audio : Audio
    """

    def __init__(self, audio: Audio) -> None:
        self._audio = audio
        self._chirp = alignment.timing_signal(audio.rate, alignment.LOOPBACK_BAND, LEVEL)
        self.whole, self.first = 0, math.nan

    def probe(self) -> Emission:
        """Four chirps and then silence for as long as a round trip can be; no drive."""
        timing = alignment.timing_train(self._chirp, 4)
        drive = np.zeros((0, len(self._audio.drive_channels)))
        return Emission(drive, timing, 0, len(timing) + round(LARGEST_ROUND_TRIP * self._audio.rate))

    def learn(self, response: np.ndarray, loopback: np.ndarray) -> str:
        """Take the session's delay from the recorded probe; return what is wrong with it, or nothing.

        Responses, shape (frames, responses), m/s^2; loopback, shape (frames,), full scale.
        """
        timing = alignment.timing_train(self._chirp, 4)
        found = alignment.delay(timing, loopback, self._audio.rate, alignment.LOOPBACK_BAND)
        if not found.quality >= TRUST:
            return (
                f"no loopback signal: its quality is {found.quality:.3f}, must be >= {TRUST}; is there a "
                f"cable from output {self._audio.loopback_output} to input {self._audio.loopback_input}, not "
                "inverted, and is the input's level right?"
            )
        self.whole, self.first = round(found.samples), found.samples
        return ""

    def emission(self, drive: np.ndarray) -> Emission:
        """Return the drive as it is, and chirps until after its end."""
        timing = alignment.timing_train(self._chirp, max(1, math.ceil(len(drive) / len(self._chirp))))
        slip = len(self._chirp)  # recorded beyond what is needed, so that a slip can be told
        return Emission(drive, timing, 0, len(timing) + self.whole + slip)

    def judge(self, emission: Emission, response: np.ndarray, loopback: np.ndarray) -> Evidence:
        """Say whether every chirp of a recording lies where the session's first delay puts it."""
        rate, band = self._audio.rate, alignment.LOOPBACK_BAND
        expected = loopback[: len(emission.timing) + self.whole]
        deviation, quality = alignment.train_deviations(self._chirp, expected, self.whole, rate, band)
        residual = deviation + self.whole - self.first
        fault = ""
        if not quality.min() >= TRUST:
            found = alignment.delay(emission.timing, loopback[: emission.frames], rate, band)
            if found.quality >= TRUST:  # all of it is there, elsewhere
                residual, quality = np.array([found.samples - self.first]), np.array([found.quality])
            else:
                start = int(np.argmax(quality < TRUST)) * len(self._chirp) / rate
                fault = f"the loopback signal is wrong from {start:.3f} s after the start"
        return evidence(residual, quality, self.first, fault)
