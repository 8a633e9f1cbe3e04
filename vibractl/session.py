"""A run: shot after shot is emitted, recorded, judged and learned from, in a folder from which it can go on."""

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.agreement import CHANNELS, DRIVE, Difference, agreed
from rigkit.provenance import software
from rigkit.run_folder import RunFolder, read_quality
from rigkit.run_origin import WAY_OUT, finish
from vibractl.audio import Line
from vibractl.capture import Discarded
from vibractl.clipped_drive import ClippedDrive
from vibractl.decibels import FAINT, decibels
from vibractl.learner import ALIKE, Learner
from vibractl.learning.changed_rig import Change
from vibractl.learning.decision import Decision, tidy
from vibractl.learning.repeatability import Repeatability
from vibractl.learning.shot import Shot
from vibractl.learning.stagnation import Stagnation
from vibractl.lines_file import write_lines
from vibractl.mains import Hum
from vibractl.place import Place
from vibractl.quality import HIDDEN, Judge, Marks
from vibractl.quality_table import floor_cells, reduced, row_of, summary
from vibractl.rig_check import SECONDS, ChangedRigError, RigCheck, changed_channels
from vibractl.run_setup import require_room, shot_files
from vibractl.setup import Setup, judged_lines
from vibractl.shot_file import DISCARDED, far_field_of, keep_discarded, recording_of, set_aside, split
from vibractl.supervision import ALONE, Supervision

POOR = 0.5
"""Of the burst's response, from which on it is said by how much the model is off."""


class Session:
    """One run, from its first shot or from where it stopped.

    Parameters
    ----------
    folder : RunFolder
    made : Setup
    supervision : Supervision
        Of its line.
    accept : collection of str
        May hold `DRIVE`: the run goes on although its drives are not those that were played; and `CHANNELS`: although
        its channels are not those of its model.

    Raises
    ------
    DisagreementError : the drives rebuilt from what is recorded are not those that were played; or the last shot, not
        judged yet, shows other channels than the model's.
    """

    def __init__(
        self, folder: RunFolder, made: Setup, supervision: Supervision = ALONE, accept: Collection[str] = ()
    ) -> None:
        self.folder, self.config, self._made = folder, made.config, made
        self._supervision, self._accept, self._said = supervision, accept, list(made.said)
        self.line: Line | None = None
        """While it is open, or after it has failed."""
        self.learner: Learner = made.learner()
        self._judges = [Judge(made, place) for place in made.places]
        self._mains = {place.name: made.mains(place) for place in made.places if place is not made.learned}
        limit = float(self._judges[made.places.index(made.learned)].limit.min())
        judged = judged_lines(made.law, made.reference, made.config)
        self._repeats = Repeatability(self.learner.algorithm, judged, limit)
        self._stagnation, self._clipped = Stagnation(), ClippedDrive(made)
        self._usual: float | None = None
        self._burst = ""
        self._resume()

    @property
    def done(self) -> int:
        """Shots recorded."""
        return self.learner.number

    @property
    def judged(self) -> Place:
        """Where the objective must hold."""
        return self._made.judged

    @property
    def seconds(self) -> float:
        """Length of a shot, s."""
        return self.learner.shot.total / self.learner.shot.rate

    @property
    def note(self) -> str:
        """What a person should know before it begins, lines of text; empty for nothing."""
        return "".join(f"{note}\n" for note in (*self._said, self._made.note, self._made.plans.note) if note)

    @property
    def untouched(self) -> bool:
        """Whether nothing at all has been recorded."""
        return not (self.done or (self.folder.path / DISCARDED).exists())

    def run(self, shots: int, tell: Callable[[int, Marks], None], stopped: Callable[[], bool]) -> None:
        """Emit until `shots` are recorded or `stopped` says so; the session can go on later either way.

        Raises
        ------
        ValueError : the next drive would break a limit of the guard.
        AudioError : the audio has failed; what is recorded stays.
        ChangedRigError : a channel is not what it was when the model was measured; what shows it is kept.
        OSError : the disk has no room for the shots that are left, or fails; what is recorded stays.
        """
        if self.done >= shots:
            return
        require_room(self.folder.path, self._made, shots - self.done)
        with self._opened() as line:
            self.folder.event("started", {"shot": self.done, "round_trip": line.round_trip, "software": software()})
            try:
                self._look_at_rig(line, stopped)
                while self.done < shots and not stopped():
                    number = self.done
                    tell(number, self._shoot(line))
            except BaseException as fault:
                self.folder.event("failed", {"shot": self.done, "fault": type(fault).__name__, "text": str(fault)})
                raise
        self.folder.event("stopped" if self.done < shots else "finished", {"shots": self.done})
        if self.done >= shots:
            finish(self.folder.path)

    @contextmanager
    def _opened(self) -> Iterator[Line]:
        """Open the line, which is `line` until it is closed."""
        longest = max(self.seconds, SECONDS)
        self.line = Line(self.config, seconds=longest, on_discard=self._discarded, supervision=self._supervision)
        try:
            with self.line as line:
                yield line
        finally:
            self.line = None

    def summary(self) -> dict[str, Any]:
        """Return the figures of the run so far, and keep them in `summary.json`."""
        figures = summary(read_quality(self.folder.path), self._made)
        self.folder.summarise(figures)
        return figures

    @property
    def _looks_at_rig(self) -> bool:
        return self.config.session.check and not self._made.learned.is_far

    def _look_at_rig(self, line: Line, stopped: Callable[[], bool]) -> None:
        """Play a weak burst, and end where its response is that of other channels than the model's."""
        if not self._looks_at_rig:
            return
        check = RigCheck.of(self._made, self.learner.drive, self.learner.algorithm.level)
        if stopped():
            return
        capture = line.emit(check.drive)
        off, worst, change = check.judge(capture.response)
        self._usual = worst
        self._burst = f"the model is {100 * off:.0f} % off the burst's response" if off > POOR else ""
        self.folder.event("checked", {"shot": self.done, "off": tidy(off), "change": change.text if change else ""})
        try:
            self._check(change)
        except ChangedRigError as fault:
            self._discarded(Discarded(1, fault.change, capture))
            raise

    def _check(self, change: Change | None, where: str = "") -> None:
        """Go no further where channels have been changed, unless that is accepted."""
        if change is not None and CHANNELS not in self._accept:
            raise ChangedRigError(f"{self.folder.path}/", where, change)

    def _shoot(self, line: Line) -> Marks:
        capture = line.emit(self.learner.drive)
        record = recording_of(capture, self.config)
        path = self.folder.shot(self.done).with_suffix(f".{self.config.session.recording}")
        recording.write(path, record)
        return self._learn_unless_changed(path, record)

    def _learn_unless_changed(self, path: Path, record: Recording, write: bool = True) -> Marks:
        """Take a recording into the learner, or away from the shots where its channels are not the model's."""
        try:
            return self._learn(record, write)
        except ChangedRigError as fault:
            self._tell_discarded(1, fault.change, set_aside(self.folder.path / DISCARDED, path))
            raise

    def _learn(self, record: Recording, write: bool = True) -> Marks:
        """Take a recording into the learner, and write what it was worth."""
        number, algorithm = self.done, self.learner.algorithm
        purpose, level = algorithm.purpose, algorithm.level
        drive, response = split(record, self.config)
        heard = response, far_field_of(record, self.config)
        self.learner.response[: len(response)] = response
        if self._made.learned.is_far:
            self.learner.far_field[:] = heard[1]
        shot = self.learner.analysed()
        if write and purpose == "learn" and self._looks_at_rig:
            self._usual, change = changed_channels(algorithm, shot, self._usual)
            self._check(change, f", shot {number}")
        repeatability = self._repeats.take(shot, purpose == "learn")  # by what is believed before it
        self.learner.follow(shot)
        pairs = zip(self._judges, heard, strict=False)
        every = [judge.marks(signals, drive, self._hum(judge, signals), level) for judge, signals in pairs]
        marks = every[self._made.places.index(self._made.judged)]
        decisions = [*algorithm.decisions, *self._remarkable(marks, shot, purpose, drive)]
        if write:
            write_lines(self.folder.shot(number), self.learner)
            told = dict(zip(self._made.places, every, strict=True))
            gain = algorithm.daring.nominal
            row = row_of(number, purpose, gain, marks, told, record.provenance, repeatability)
            self.folder.quality(row | floor_cells(self._repeats.floor) | reduced(purpose, marks))
            for decision in decisions:
                self.folder.event(decision.event, {"shot": number, **decision.fields})
        return marks

    @property
    def remark(self) -> str:
        """Why learning stands still or errors grow, and which bins of the drive are held; empty while all is well."""
        said = self._burst, self._stagnation.text, self._clipped.text, self.learner.held
        return "; ".join(text for text in said if text)

    def said_of(self, marks: Marks) -> str:
        """Return what a person should know of the last shot, in one line."""
        return "; ".join(text for text in (f"objective {marks.reason}", self.remark) if text)

    def _remarkable(self, marks: Marks, shot: Shot, purpose: str, drive: np.ndarray) -> list[Decision]:
        """Follow whether shots get better, and whether drives are cut off, where shots are judged by what is learned.

        `drive`, shape (samples, coils), V, is what was emitted.
        """
        if purpose != "learn" or self._made.judged is not self._made.learned:
            return []
        side = int(np.argmax(marks.worst_line_db))
        over, place = float(marks.worst_line_db[side]), float(marks.worst_line_hz[side])
        still = self._stagnation.take(over, place, shot, self.learner.algorithm, marks.verdict == HIDDEN)
        cut = self._clipped.take(drive, shot) if over > 0 and not self._made.learned.is_far else None
        return [decision for decision in (still, cut) if decision is not None]

    def _hum(self, judge: Judge, heard: np.ndarray) -> Hum | None:
        """Return the mains' hum in what a judge's sensors have heard."""
        if judge.place is self._made.learned:
            return self.learner.hum
        mains = self._mains[judge.place.name]
        return None if mains is None else judge.hum(heard, mains)

    def _resume(self) -> None:
        files = shot_files(self.folder.path)
        judged = len(read_quality(self.folder.path))
        off = 0.0
        for number, path in enumerate(files):
            record = recording.read(path)
            drive, _ = split(record, self.config)
            off = float(np.linalg.norm(drive - self.learner.drive)) / max(float(np.linalg.norm(drive)), FAINT)
            if DRIVE in self._accept:  # from what was played, whatever would be rebuilt
                self.learner.played(drive)
            self._learn_unless_changed(path, record, write=number >= judged)
        if not files:
            return
        if not off <= ALIKE:  # NaN as well
            what = Difference(DRIVE, "as recorded", f"{decibels(off):.1f} dB beside it, rebuilt", True)
            self._said += agreed([what], self._accept, f"{self.folder.path}/, shot {len(files) - 1}", WAY_OUT)
        self.folder.event("resumed", {"shots": len(files)})

    def _discarded(self, discarded: Discarded) -> None:
        """Keep a recording that nothing is learned from, and say why."""
        kept = keep_discarded(self.folder.path / DISCARDED, f"{self.done:04d}", discarded, self.config)
        self._tell_discarded(discarded.attempt, discarded.reason, kept)

    def _tell_discarded(self, attempt: int, reason: str, kept: Path) -> None:
        fields = {"shot": self.done, "attempt": attempt, "reason": reason, "kept": kept.name}
        self.folder.event("discarded", fields)
