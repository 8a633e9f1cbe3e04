"""One iteration of the law for whoever plays drives with other software: from a recorded shot to the next drive."""

from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vibractl.capture import Capture, spoiled, unmoved
from vibractl.decibels import FAINT
from vibractl.foreign.pair import find_shot
from vibractl.foreign.signals import drives_of, read_kind, responses_of
from vibractl.foreign.step_state import Step, StepState, checksum
from vibractl.learner import Learner
from vibractl.learning.shot import Shot
from vibractl.loudness import too_loud
from vibractl.proof import SLIP
from vibractl.quality import Judge, Marks
from vibractl.setup import Setup

UNRELATED = 0.2
"""Correlation of a response with what the model expects, below which they have nothing to do with each other."""


class StepError(ValueError):
    """A recording that nothing may be learned from, or a drive that may not be played."""


@dataclass(frozen=True)
class Stepped:
    """What a step made of a shot.

    Parameters
    ----------
    state : StepState
        With that shot.
    marks : Marks
    shot : int, counted from 0
    first : int, samples
        Where the shot lies in its recording.
    """

    state: StepState
    marks: Marks
    shot: int
    first: int


class Stepper:
    """A learning put together again where it stands.

    Parameters
    ----------
    state : StepState
    made : Setup
        Of the state's folder.

    Raises
    ------
    StepError : it learns or is judged in the far field.
    """

    def __init__(self, state: StepState, made: Setup) -> None:
        if made.learned.is_far or made.judged.is_far:
            raise StepError(
                "learning.sensors or quality.where is far-field, must be accelerometers: no hydrophone is recorded here"
            )
        self.state, self._made = state, made
        """Where it stands."""
        self._learner: Learner = made.learner()
        self._judge = Judge(made, made.judged)
        for step in state.steps:
            if self._learner.mains is not None and step.mains:
                self._learner.mains.follow(step.mains)
            self._learner.follow(Shot(self._learner.lines, step.heard, step.noise))

    @property
    def drive(self) -> np.ndarray:
        """The drive to be played now, (samples, drives), V.

        Raises
        ------
        StepError : it would break a limit of the guard.
        """
        drive = self._learner.drive
        broken = too_loud(drive, self._made.config.limits, self._made.config.audio.rate)
        if broken:
            raise StepError(f"the next drive is not written: {broken}")
        return drive.copy()

    def take(self, played: Path, heard: Path) -> Stepped:
        """Learn from a shot; `drive` is the next one then.

        Parameters
        ----------
        played, heard : Path
            Files with the drives as they were played, and with the responses, sample by sample beside them.

        Raises
        ------
        StepError, RecordingError : nothing may be learned from it; it says why, and nothing has changed.
        """
        audio, shot, number = self._made.config.audio, self._made.shot, len(self.state.steps)
        drive = read_kind(played, drives_of(audio), audio.rate)
        response = read_kind(heard, responses_of(audio), audio.rate).astype(np.float32)
        cut = find_shot(self._learner.drive, drive, audio.rate, str(played))
        if number and not abs(cut.fraction - self.state.fraction) <= SLIP:
            raise StepError(
                f"{played}: comes {cut.fraction - self.state.fraction:+.2f} samples off the first shot, must be within"
                f" {SLIP:g}"
            )
        if len(response) < cut.first + shot.total:
            raise StepError(
                f"{heard}: {len(response)} samples, must be at least {cut.first + shot.total}: the shot begins at "
                f"sample {cut.first} and is {shot.total} long"
            )
        response = response[cut.first : cut.first + shot.total]
        self._refuse_spoiled(drive[cut.first : cut.first + shot.total], response, heard)
        name = checksum(response)
        known = [step.recording for step in self.state.steps]
        if name in known:
            raise StepError(f"{heard}: was learned from before, as shot {known.index(name)}; record the drive again")
        self._learner.response[: len(response)] = response
        followed = deepcopy(self._learner.mains)
        taken = self._learner.analysed()
        level = self._learner.algorithm.level
        marks = self._judge.marks(response, drive[cut.first :], self._learner.hum, level)
        try:
            self._refuse_unrelated(taken, heard)
        except StepError:
            self._learner.mains = followed
            raise
        self._learner.follow(taken)
        figures = {"met": marks.met, "margin_db": -float(marks.worst_line_db.max()), "reason": marks.reason}
        state = self.state.after(Step(taken.response, taken.noise, name, figures, taken.mains), cut.fraction)
        self.state = state
        return Stepped(state, marks, number, cut.first)

    def _refuse_spoiled(self, drive: np.ndarray, response: np.ndarray, heard: Path) -> None:
        nothing = np.zeros((len(response), 0), np.float32)
        capture = Capture(drive.astype(np.float32), response, nothing, np.zeros(len(response)), 0.0, 0.0, 1.0, 0, 0, 0)
        reason = spoiled(capture, self._made.config.audio) or unmoved(capture)
        if reason:
            raise StepError(f"{heard}: {reason}")

    def _refuse_unrelated(self, shot: Shot, heard: Path) -> None:
        """Refuse a response that is nothing like what the model expects of this drive."""
        expected = self._learner.algorithm.belief.explained(shot.drive)
        size = float(np.linalg.norm(expected)) * float(np.linalg.norm(shot.response))
        spacing = self._made.law.matrix.frequency
        cross = np.sum(expected.conj() * shot.response, axis=1)
        likeness = np.abs(np.fft.fft(cross, 8 * len(spacing))) / max(size, FAINT)
        if not likeness[0] >= UNRELATED:
            best = int(likeness.argmax())
            late = best if best <= len(likeness) // 2 else best - len(likeness)
            seconds = -late / (len(likeness) * (spacing[1] - spacing[0]))
            where = (
                f"; it is most like it {seconds:+.3f} s later, {likeness[best]:.2f}" if likeness[best] >= 0.5 else ""
            )
            raise StepError(
                f"{heard}: does not belong to this drive: correlation {likeness[0]:.2f} with what the model expects, "
                f"must be >= {UNRELATED:g}{where}"
            )
