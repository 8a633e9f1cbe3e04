"""Proof of alignment: what is emitted beside a drive, or around it, so that the recording shows where it lies."""

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

LARGEST_ROUND_TRIP = 0.5
"""s, searched when the stream is opened."""
SLIP = 0.25
"""samples: a shot whose delay differs by more from the session's first is not learned from."""


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


def evidence(residual: np.ndarray, quality: np.ndarray, first: float, fault: str) -> Evidence:
    """Sum up what the timing signals of one recording say.

    Parameters
    ----------
    residual : array, shape (signals,), samples
        Each one's delay less the session's first.
    quality : array, shape (signals,), 1
    first : float, samples
    fault : str
        What is wrong with a signal itself; empty when they are all as they should be.

    Returns
    -------
    Evidence
        With a fault as well when a residual is more than `SLIP`.
    """
    worst = float(residual[np.argmax(np.abs(residual))]) if np.isfinite(residual).all() else math.nan
    if fault:
        fault += f": quality {quality.min():.3f}"
    elif not abs(worst) <= SLIP:
        fault = f"slip: the delay is {first + worst:.2f} samples, the session's first {first:.2f}"
    return Evidence(first + float(np.mean(residual)), worst, float(quality.min()), fault)
