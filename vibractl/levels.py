"""What is played and heard in this moment, read from the memory that the audio callback writes."""

from dataclasses import dataclass

import numpy as np

from vibractl.audio_memory import Memory, Word
from vibractl.config import Audio, Limits

LATELY = 0.25
"""s over which a peak is taken."""


@dataclass(frozen=True, eq=False)
class Levels:
    """How the stream stands.

    Parameters
    ----------
    drive_peak, drive_rms : array, shape (drives, ), V
        Of the last quarter of a second, and of the last `limits.rms_seconds`, of the emission under way.
    response_peak : array, shape (responses, ), m/s^2
    played : float, s
        Of the emission under way; 0 between two.
    xruns, late : int
        Callbacks of the last emission with a flag for lost data, and late ones.
    callbacks, beats : int
        Since the stream was opened; beats: heartbeats that the relay's bus has taken.
    """

    drive_peak: np.ndarray
    drive_rms: np.ndarray
    response_peak: np.ndarray
    played: float
    xruns: int
    late: int
    callbacks: int
    beats: int


def levels(memory: Memory, audio: Audio, limits: Limits) -> Levels:
    """Return how the stream stands; silence between two emissions."""
    words, position = memory.words, _position(memory)
    lately = slice(max(0, position - round(LATELY * audio.rate)), position)
    averaged = max(1, round(limits.rms_seconds * audio.rate))
    square = np.square(memory.emitted[max(0, position - averaged) : position], dtype=float).sum(axis=0)
    return Levels(
        np.abs(memory.emitted[lately]).max(axis=0, initial=0.0),
        np.sqrt(square / averaged),
        np.abs(memory.response[lately]).max(axis=0, initial=0.0),
        position / audio.rate,
        int(words[Word.INPUT_XRUNS] + words[Word.OUTPUT_XRUNS]),
        int(words[Word.LATE]),
        int(words[Word.CALLBACKS]),
        int(words[Word.BEATS]),
    )


def lately(memory: Memory, audio: Audio, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Return what was played and heard in the last `seconds` of the emission under way; nothing before it is so old.

    Returns
    -------
    emitted : array, shape (samples, drives), V
    response : array, shape (samples, responses), m/s^2
    """
    position, wanted = _position(memory), round(seconds * audio.rate)
    part = slice(position - wanted, position) if position >= wanted else slice(0, 0)
    return memory.emitted[part].copy(), memory.response[part].copy()


def _position(memory: Memory) -> int:
    """Return how many samples of the emission under way have been recorded; 0 between two."""
    words = memory.words
    return int(words[Word.POSITION]) if words[Word.DONE] != words[Word.REQUEST] else 0
