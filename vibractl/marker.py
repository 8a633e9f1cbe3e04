"""Proof of alignment without a cable: short quiet chirps through the vibrator, before and after the drive."""

import math

import numpy as np

from rigkit.fade import rise
from vibractl import alignment
from vibractl.config import Audio, Limits
from vibractl.proof import LARGEST_ROUND_TRIP, Emission, Evidence, evidence

LEVEL = 10 ** (-50 / 20)
"""of limits.peak."""
TRUST = 0.9
"""Least quality of each marker: the sensors' noise may be 6 dB below it."""
GAP = 0.25
"""s of silence beside a marker, longer than the round trip and what the vibrator rings at 1 kHz and above."""
CHIRPS = 4
"""A marker is so many chirps, a tenth of a second, for the sake of the sensors' noise."""
PROBES = 8
"""Markers that the session's first delay and template are the mean of."""


class Marker:
    """A few short quiet chirps on the first drive, before and after the caller's, compared with the session's first.

    It passes the guard and the vibrator, whose own delay is part of the round trip then, always the same.  What goes
    wrong in mid-shot and is right again at its end is not seen: where there is a spare channel, use the cable.

    Parameters
    ----------
    audio : Audio
    limits : Limits
    """

    def __init__(self, audio: Audio, limits: Limits) -> None:
        self._audio = audio
        chirp = alignment.timing_signal(audio.rate, alignment.MARKER_BAND, LEVEL * limits.peak)
        self._chirp = alignment.timing_train(chirp, CHIRPS)
        self._lead = len(chirp) // 2  # of the window before the marker, and of silence for it
        self._window = np.ones(len(self._chirp) + 2 * self._lead)
        self._window[: self._lead] = rise(self._lead)
        self._window[-self._lead :] = self._window[self._lead - 1 :: -1]
        self._gap = round(GAP * audio.rate)
        self._template = np.zeros(len(self._window))
        self.whole, self.first = 0, math.nan

    def probe(self) -> Emission:
        """Eight markers, each followed by silence for as long as a round trip can be."""
        period = np.zeros((round(LARGEST_ROUND_TRIP * self._audio.rate), len(self._audio.drive_channels)))
        period[self._lead : self._lead + len(self._chirp), 0] = self._chirp
        drive = np.tile(period, (PROBES, 1))
        return Emission(drive, np.zeros(0), 0, len(drive))

    def learn(self, response: np.ndarray, loopback: np.ndarray) -> str:
        """Take the session's delay, and what a marker looks like, from the recorded probe; return what is wrong.

        Responses, shape (frames, responses), m/s^2; loopback is not looked at, shape (frames,).
        """
        periods = response[:, 0].astype(float).reshape(PROBES, -1)
        found = alignment.delay(self._chirp, periods.mean(axis=0), self._audio.rate, alignment.MARKER_BAND)
        whole = max(0, round(np.nan_to_num(found.samples)) - self._lead)
        if whole + len(self._window) > periods.shape[1]:
            return f"the marker comes {whole} samples late, must be <= {periods.shape[1] - len(self._window)}"
        markers = periods[:, whole : whole + len(self._window)]
        self._template = markers.mean(axis=0)
        quality = self._compare(markers)[1].min()
        self.whole, self.first = whole, float(whole)
        if not quality >= TRUST:
            return (
                f"the marker is not detected: its quality is {quality:.3f}, must be >= {TRUST}; is drive 1 on "
                f"output {self._audio.drive_channels[0]}, response 1 on input {self._audio.response_channels[0]}, "
                "and the amplifier on?"
            )
        return ""

    def emission(self, drive: np.ndarray) -> Emission:
        """Return the drive, shape (samples, drives), V, between two markers."""
        marker = np.zeros((self._lead + len(self._chirp), drive.shape[1]))
        marker[self._lead :, 0] = self._chirp
        rest = np.zeros((self._gap, drive.shape[1]))
        whole = np.concatenate((marker, rest, drive, rest, marker))
        return Emission(whole, np.zeros(0), len(marker) + self._gap, len(whole) + self._lead + self.whole)

    def judge(self, emission: Emission, response: np.ndarray, loopback: np.ndarray) -> Evidence:
        """Say whether both markers of responses, shape (frames, responses), lie where the session's first put them.

        Loopback, shape (frames,), is not looked at.
        """
        starts = self.whole, self.whole + len(emission.drive) - self._lead - len(self._chirp)
        windows = [response[start : start + len(self._window), 0].astype(float) for start in starts]
        residual, quality = self._compare(np.stack(windows))
        place = ("before", "after")[int(np.argmin(quality))]
        fault = "" if quality.min() >= TRUST else f"the marker {place} the drive is wrong"
        return evidence(residual, quality, self.first, fault)

    def _compare(self, recorded: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return alignment.deviations(
            self._template * self._window, recorded * self._window, self._audio.rate, alignment.MARKER_BAND
        )
