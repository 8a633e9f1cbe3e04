"""One recorded response against a reference: found in its recording, cut out, and judged as a shot of a run is."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from ctlblocks.recording import RecordingError
from vibractl.foreign.timing import ORDER, Timing, places, timing
from vibractl.judging import Judging
from vibractl.learner import Timeline
from vibractl.quality import Judge, Marks, decibels

LIKE = 0.5
"""Least correlation with the reference: a response of which three quarters of the power is something else is found."""
STILL = 1e-3
"""samples: a fraction below is left as it is."""


@dataclass(frozen=True)
class Verdict:
    """What one recording is worth.

    Parameters
    ----------
    marks : Marks
    found : Timing
        Of the reference in the recording, over all sides at once.
    error : array, shape (frames, sides), m/s^2
        Reference minus response at the learner's rate.
    silence : array, shape (lines, sides), m/s^2 s, or None
        RMS of the lines in silence, where that was given.
    judge : Judge
    """

    marks: Marks
    found: Timing
    error: np.ndarray
    silence: np.ndarray | None
    judge: Judge

    @property
    def worst_side(self) -> int:
        """The side whose line is nearest to the limit, or farthest above; counted from 0."""
        return int(np.argmax(self.marks.worst_line_db))

    @property
    def silence_db(self) -> np.ndarray | None:
        """By how much silence is over the limit on its worst line, (sides,), dB: negative is good."""
        if self.silence is None:
            return None
        over: np.ndarray = decibels(self.silence[self.judge.judged] / self.judge.limit).max(axis=0)
        return over

    @property
    def is_noise(self) -> bool:
        """Whether the worst line is as loud in silence, to 3 dB."""
        if self.silence is None:
            return False
        side = self.worst_side
        line = int(np.argmin(np.abs(self.judge.frequency - self.marks.worst_line_hz[side])))
        size = abs(self.judge.lines(self.error)[line, side])
        return bool(self.silence[line, side] > 10 ** (-3 / 20) * size)


def judged(made: Judging, response: np.ndarray, silence: np.ndarray | None, name: str) -> Verdict:
    """Judge a recording.

    Parameters
    ----------
    made : Judging
    response : array, shape (samples, sensors), m/s^2
        With the reference anywhere in it.
    silence : array, shape (samples, sensors), m/s^2, optional
        Of the same sensors, without a drive; at least as long as a shot.
    name : str
        Of the recording, for errors.

    Raises
    ------
    RecordingError : the reference is not in it, or it is too short.
    """
    sides, frames = list(made.places[0].sensors), made.shot.frames
    reference, heard = made.reference.signal, response[:, sides]
    if len(heard) < frames:
        raise RecordingError(f"{name}: {len(heard)} samples, must be at least {frames}, the reference's")
    if not np.any(heard):
        raise RecordingError(f"{name}: silent, must hold a response")
    likeness = places(reference, heard)
    first = int(likeness.argmax())
    if not likeness[first] >= LIKE:
        raise RecordingError(
            f"{name}: does not hold the reference: correlation {likeness[first]:.2f} where they are most alike, must "
            f"be >= {LIKE:g}"
        )
    found = timing(reference, heard, made.shot.rate, float(first), with_drift=False)
    judge = Judge(made)
    placed = _placed(response, found, made.shot)
    quiet = None if silence is None else _quiet(judge, silence, made.shot)
    marks = judge.marks(placed, np.zeros((1, len(made.config.audio.drive_channels))))
    return Verdict(marks, found, judge.error(placed), quiet, judge)


def _placed(response: np.ndarray, found: Timing, shot: Timeline) -> np.ndarray:
    """Return what lies around the reference as a whole shot; silence where the recording has begun later, or ended."""
    fraction = found.delay - found.whole
    if abs(fraction) > STILL:
        index = np.arange(len(response))
        response = make_interp_spline(index, response, k=ORDER)(np.clip(index + fraction, 0, len(response) - 1))
    first = found.whole - shot.lead
    taken = slice(max(first, 0), min(first + shot.total, len(response)))
    placed = np.zeros((shot.total, response.shape[1]))
    placed[taken.start - first : taken.stop - first] = response[taken]
    return placed


def _quiet(judge: Judge, silence: np.ndarray, shot: Timeline) -> np.ndarray:
    """Return the RMS of the lines in silence, (lines, sides), over all stretches as long as the reference."""
    empty = judge.error(np.zeros((shot.total, silence.shape[1])))
    starts = range(0, len(silence) - shot.total + 1, shot.frames)
    every = [np.abs(judge.lines(judge.error(silence[at : at + shot.total]) - empty)) ** 2 for at in starts]
    size: np.ndarray = np.sqrt(np.mean(every, axis=0))
    return size
