"""Proof of alignment: what is emitted beside a drive, or around it, so that the recording shows where it lies."""

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from vibractl import alignment
from vibractl.config import Audio, Limits

LARGEST_ROUND_TRIP = 0.5
"""s, searched when the stream is opened."""
SLIP = 0.25
"""samples: a shot whose delay differs by more from the session's first is not learned from."""
LOOPBACK_LEVEL = 0.1
"""full scale: 20 dB down, so that crosstalk stays far below the responses."""
LOOPBACK_TRUST = 0.995
"""Least quality of each chirp: 20 dB of noise, or 10 samples of 1024 lost, is too much."""
MARKER_LEVEL = 10 ** (-50 / 20)
"""of limits.peak."""
MARKER_TRUST = 0.9
MARKER_GAP = 0.25
"""s of silence beside a marker, longer than the round trip and what the vibrator rings at 1 kHz and above."""
MARKER_CHIRPS = 4
"""A marker is so many chirps, a tenth of a second, for the sake of the sensors' noise."""
MARKER_PROBES = 8


class Emission(NamedTuple):
    """What the stream plays in one go, and for how long it records.

    Parameters
    ----------
    drive : array, shape (samples, drives), V
    timing : array, shape (samples,), full scale
        For the loopback output; empty when there is none.
    before : int, samples of `drive` before the caller's
    frames : int, samples to record
    """

    drive: np.ndarray
    timing: np.ndarray
    before: int
    frames: int


@dataclass(frozen=True)
class Evidence:
    """What a recording says about its own alignment.

    Parameters
    ----------
    delay : float, samples
    residual : float, samples
        Largest difference of any chirp's delay from the session's first delay.
    quality : float, 1
        The worst chirp's; see `alignment.Delay`.
    fault : str
        Why the recording cannot be trusted; empty when it can.
    """

    delay: float
    residual: float
    quality: float
    fault: str


class Proof(Protocol):
    """A way to prove alignment, which learns the session's delay once and then judges every recording."""

    whole: int
    """Samples by which responses come late, once `learn` was called."""
    first: float
    """The same with its fraction."""

    def probe(self) -> Emission:
        """Return what to emit when the stream is opened."""

    def learn(self, response: np.ndarray, loopback: np.ndarray) -> str:
        """Take the session's delay from the recorded probe; return what is wrong with it, or nothing.

        Responses, shape (frames, responses), m/s^2; loopback, shape (frames,), full scale.
        """

    def emission(self, drive: np.ndarray) -> Emission:
        """Return what to emit for a drive, shape (samples, drives), V."""

    def judge(self, emission: Emission, response: np.ndarray, loopback: np.ndarray) -> Evidence:
        """Say whether responses, shape (frames, responses), and loopback, shape (frames,), lie where they should."""


class Loopback:
    """A cable from an output to an input, with a chirp after a chirp for as long as the drive lasts.

    Every sample of a shot lies under some chirp, so a lost block or a slip in mid-shot shows, wherever it is.

    Parameters
    ----------
    audio : Audio
    """

    def __init__(self, audio: Audio) -> None:
        self._audio = audio
        self._chirp = alignment.timing_signal(audio.rate, alignment.LOOPBACK_BAND, LOOPBACK_LEVEL)
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
        if not found.quality >= LOOPBACK_TRUST:
            return (
                f"no loopback signal: its quality is {found.quality:.3f}, must be >= {LOOPBACK_TRUST}; is there a "
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
        if not quality.min() >= LOOPBACK_TRUST:
            found = alignment.delay(emission.timing, loopback[: emission.frames], rate, band)
            if found.quality >= LOOPBACK_TRUST:  # all of it is there, elsewhere
                residual, quality = np.array([found.samples - self.first]), np.array([found.quality])
            else:
                start = int(np.argmax(quality < LOOPBACK_TRUST)) * len(self._chirp) / rate
                fault = f"the loopback signal is wrong from {start:.3f} s after the start"
        return _evidence(residual, quality, self.first, fault)


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
        chirp = alignment.timing_signal(audio.rate, alignment.MARKER_BAND, MARKER_LEVEL * limits.peak)
        self._chirp = alignment.timing_train(chirp, MARKER_CHIRPS)
        self._lead = len(chirp) // 2  # of the window before the marker, and of silence for it
        self._window = np.ones(len(self._chirp) + 2 * self._lead)
        self._window[: self._lead] = 0.5 - 0.5 * np.cos(np.pi * (np.arange(self._lead) + 0.5) / self._lead)
        self._window[-self._lead :] = self._window[self._lead - 1 :: -1]
        self._gap = round(MARKER_GAP * audio.rate)
        self._template = np.zeros(len(self._window))
        self.whole, self.first = 0, math.nan

    def probe(self) -> Emission:
        """Eight markers, each followed by silence for as long as a round trip can be."""
        period = np.zeros((round(LARGEST_ROUND_TRIP * self._audio.rate), len(self._audio.drive_channels)))
        period[self._lead : self._lead + len(self._chirp), 0] = self._chirp
        drive = np.tile(period, (MARKER_PROBES, 1))
        return Emission(drive, np.zeros(0), 0, len(drive))

    def learn(self, response: np.ndarray, loopback: np.ndarray) -> str:
        """Take the session's delay, and what a marker looks like, from the recorded probe; return what is wrong.

        Responses, shape (frames, responses), m/s^2; loopback is not looked at, shape (frames,).
        """
        periods = response[:, 0].astype(float).reshape(MARKER_PROBES, -1)
        found = alignment.delay(self._chirp, periods.mean(axis=0), self._audio.rate, alignment.MARKER_BAND)
        whole = max(0, round(np.nan_to_num(found.samples)) - self._lead)
        if whole + len(self._window) > periods.shape[1]:
            return f"the marker comes {whole} samples late, must be <= {periods.shape[1] - len(self._window)}"
        markers = periods[:, whole : whole + len(self._window)]
        self._template = markers.mean(axis=0)
        quality = self._compare(markers)[1].min()
        self.whole, self.first = whole, float(whole)
        if not quality >= MARKER_TRUST:
            return (
                f"the marker is not heard: its quality is {quality:.3f}, must be >= {MARKER_TRUST}; is drive 1 on "
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
        fault = "" if quality.min() >= MARKER_TRUST else f"the marker {place} the drive is wrong"
        return _evidence(residual, quality, self.first, fault)

    def _compare(self, recorded: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return alignment.deviations(
            self._template * self._window, recorded * self._window, self._audio.rate, alignment.MARKER_BAND
        )


def proof(audio: Audio, limits: Limits) -> Proof:
    """Return the proof that a rig file asks for."""
    return Loopback(audio) if audio.alignment == "loopback" else Marker(audio, limits)


def _evidence(residual: np.ndarray, quality: np.ndarray, first: float, fault: str) -> Evidence:
    worst = float(residual[np.argmax(np.abs(residual))]) if np.isfinite(residual).all() else math.nan
    if fault:
        fault += f": quality {quality.min():.3f}"
    elif not abs(worst) <= SLIP:
        fault = f"slip: the delay is {first + worst:.2f} samples, the session's first {first:.2f}"
    return Evidence(first + float(np.mean(residual)), worst, float(quality.min()), fault)
