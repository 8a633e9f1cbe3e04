"""One recorded response against a reference: found in its recording, cut out, and judged as a shot of a run is."""

from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
from scipy.signal import hilbert

from ctlblocks.recording import RecordingError
from rigkit.foreign_stream import Signals
from rigkit.progress import progress
from vibractl.decibels import decibels
from vibractl.foreign.near import STILL, moved
from vibractl.foreign.search import Found, find
from vibractl.foreign.timing import Timing, timing
from vibractl.judging import Judging
from vibractl.learner import Timeline
from vibractl.quality import Judge, Marks
from vibractl.reference import Reference

LIKE = 0.5
"""Least correlation with the reference: a response of which three quarters of the power is something else is found."""


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


def judged(made: Judging, response: Signals, silence: Signals | None) -> Verdict:
    """Judge a recording of any length, in memory for a few shots.

    Parameters
    ----------
    made : Judging
    response : Signals, a channel a sensor, m/s^2
        With the reference anywhere in it.
    silence : Signals, a channel a sensor, m/s^2, optional
        Of the same sensors, without a drive; at least as long as a shot.

    Raises
    ------
    RecordingError : the reference is not in it, it is too short, or what is found while it is read.
    """
    judge = Judge(made)
    quiet = None if silence is None else silent_lines(judge, silence, made.shot)
    sides, shot, name = list(made.places[0].sensors), made.shot, response.path
    found = _found(made.reference, response, sides)
    if found.frames < shot.sounded:
        raise RecordingError(f"{name}: {found.frames} samples, must be at least {shot.sounded}, the reference's")
    if found.is_silent:
        raise RecordingError(f"{name}: silent, must hold a response")
    if not found.likeness >= LIKE:
        raise RecordingError(
            f"{name}: does not hold the reference: correlation {found.likeness:.2f} where they are most alike, must "
            f"be >= {LIKE:g}{_in_another_phase(made.reference.sounded, response, sides)}"
        )
    reach = shot.total + shot.frames // 100 + 1_000
    start = max(found.first - reach, 0)
    near = response.part(start, found.first + shot.frames + reach)
    there = timing(made.reference.signal, near[:, sides], shot.rate, float(found.first - start), with_drift=False)
    placed = _placed(near, there, shot)
    error = judge.error(placed)  # what lies around the reference may be driven as well: it is no silence
    marks = judge.marks_of(error, np.zeros((1, len(made.config.audio.drive_channels))))
    return Verdict(marks, replace(there, delay=there.delay + start), error, quiet, judge)


def _in_another_phase(reference: np.ndarray, response: Signals, sides: list[int]) -> str:
    """Return what is to be said where the recording is like the reference a quarter of a period off; else nothing."""
    turned = find(np.imag(hilbert(reference, axis=0)), (block[:, sides] for block in response.blocks()))
    if not turned.likeness >= LIKE:
        return ""
    return (
        f"; {turned.likeness:.2f} with each of its tones a quarter of a period off: chirp:F0:F1:SECONDS begins as a "
        "sine, scipy.signal.chirp as a cosine, so give the sweep as it was played, --reference SWEEP.wav"
    )


def _found(reference: Reference, response: Signals, sides: list[int]) -> Found:
    """Search the whole recording, as if silence came after it, and show how far that is."""
    heard = (block[:, sides] for block in response.blocks())
    with progress("searching", response.frames or 0) as meter:
        found = find(reference.signal, chain(heard, [np.zeros((reference.rest, len(sides)))]), meter.show)
    return replace(found, frames=found.frames - reference.rest)


def _placed(response: np.ndarray, found: Timing, shot: Timeline) -> np.ndarray:
    """Return what lies around the reference as a whole shot; silence where the recording has begun later, or ended."""
    fraction = found.delay - found.whole
    if abs(fraction) > STILL:
        response = moved(response, np.arange(len(response)) + fraction)
    first = found.whole - shot.lead
    taken = slice(max(first, 0), min(first + shot.total, len(response)))
    placed = np.zeros((shot.total, response.shape[1]))
    placed[taken.start - first : taken.stop - first] = response[taken]
    return placed


def silent_lines(judge: Judge, silence: Signals, shot: Timeline) -> np.ndarray:
    """Return the RMS of the lines in silence, (lines, sides), m/s^2 s, over all stretches as long as the reference.

    Parameters
    ----------
    judge : Judge
    silence : Signals
    shot : Timeline

    Raises
    ------
    RecordingError : it is shorter than a shot.
    """
    empty = judge.error(np.zeros((shot.total, len(silence.names))))
    power, stretches = np.zeros(1), 0
    held = np.empty((0, len(silence.names)))
    for block in silence.blocks(shot.frames):
        held = np.concatenate((held, block))
        while len(held) >= shot.total:
            power = power + np.abs(judge.lines(judge.error(held[: shot.total]) - empty)) ** 2
            held, stretches = held[shot.frames :], stretches + 1
    if not stretches:
        raise RecordingError(f"{silence.path}: {len(held)} samples, must be at least {shot.total}, a shot's")
    size: np.ndarray = np.sqrt(power / stretches)
    return size
