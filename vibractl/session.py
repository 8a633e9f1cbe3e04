"""A run: shot after shot is emitted, recorded, judged and learned from, in a folder from which it can go on."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of, megabytes
from rigkit import config as rig_file
from rigkit.disk_space import require
from rigkit.provenance import software
from rigkit.run_folder import RunFolder, read_quality
from rigkit.sealed_file import sealed
from vibractl.audio import Line
from vibractl.capture import Discarded
from vibractl.config import RigConfig
from vibractl.fft_plans import Plans
from vibractl.learner import Learner
from vibractl.library.entry import Entry, read_entry, write_entry
from vibractl.model_file import read_far_field, read_model
from vibractl.place import Place
from vibractl.quality import FAINT, Judge, Marks, decibels
from vibractl.quality_table import reduced, row_of, summary
from vibractl.reference import is_file
from vibractl.setup import Setup, setup, warm_setup
from vibractl.shot_file import DISCARDED, far_field_of, keep_discarded, recording_of, split
from vibractl.supervision import ALONE, Supervision

MODEL, WISDOM, REFERENCE, START = "model.h5", "fftw.wisdom", "reference", "start.h5"


def create(
    path: Path, config: RigConfig, model: Path, entry: Entry | None = None, shots: int = 0
) -> tuple[RunFolder, Setup]:
    """Check everything a run needs, and then make its folder.

    Parameters
    ----------
    path : Path
        Absent or empty.
    config : RigConfig
    model : Path
        Model file of this rig.
    entry : Entry, optional
        Of the library, to be checked and started from; refused at once where its drive breaks a limit of the guard.
    shots : int
        To be recorded; 0 for `session.shots`.

    Raises
    ------
    ValueError : settings, model and reference do not fit, or the folder is in use; nothing is written.
    DiskFault : the disk has no room for the shots; nothing is written.
    """
    sides = len(config.audio.response_channels), len(config.audio.drive_channels)
    far = read_far_field(model, len(config.audio.far_field_channels))
    matrix = read_model(model, config.rig.name, sides)
    if entry is None:
        made, broken = setup(config, matrix, far, plans=Plans.of_user()), None
    else:
        made, broken = warm_setup(config, matrix, far, entry, Plans.of_user())
    config = made.config
    require_room(path, made, shots or config.session.shots)
    source = Path(config.reference.signal) if is_file(config.reference.signal) else None
    kept = config
    if source is not None:
        name = REFERENCE + source.suffix.lower()
        kept = config.model_copy(update={"reference": config.reference.model_copy(update={"signal": name})})
    with RunFolder.filled(path, rig_file.dump(kept)) as folder:
        folder.take_in(model, MODEL)
        if source is not None:
            folder.take_in(source, kept.reference.signal)
        folder.write(WISDOM, made.plans.wisdom)
        if entry is not None:
            write_entry(folder.path / START, entry)
            folder.event("library", {"entry": entry.name, "tags": dict(entry.tags), "run": entry.about["run"]})
            if broken is not None:
                folder.event("library_refused", {"entry": entry.name, "limit": str(broken)})
    return folder, made


def settings_of(path: Path, overrides: tuple[str, ...] = ()) -> RigConfig:
    """Return the settings of a run folder, with what is laid over them."""
    config = rig_file.load(path / "config.toml", RigConfig, overrides)
    own = path / config.reference.signal
    if is_file(config.reference.signal) and own.is_file():
        config = config.model_copy(update={"reference": config.reference.model_copy(update={"signal": str(own)})})
    return config


def setup_of(path: Path, overrides: tuple[str, ...] = (), model: Path | None = None) -> Setup:
    """Put the run of a folder together again, with the FFT plans it was made with.

    Raises
    ------
    ValueError : the folder lacks a part, or the parts do not fit.
    """
    config = settings_of(path, overrides)
    plans = Plans.of_run(path / WISDOM)
    matrix = read_model(model or path / MODEL, config.rig.name)
    far = read_far_field(model or path / MODEL, len(config.audio.far_field_channels))
    entry = read_entry(path / START) if config.learning.start == "library" else None
    return setup(config, matrix, far, entry, plans)


def require_room(path: Path, made: Setup, shots: int) -> None:
    """Refuse, by a `DiskFault`, what the disk cannot hold: so many shots, and a tenth more for what is kept of lines.

    Parameters
    ----------
    path : Path
        Folder of the run; need not exist.
    made : Setup
    shots : int
        That are still to be recorded.
    """
    audio = made.config.audio
    sensors = len(audio.response_channels) + len(audio.far_field_channels)
    channels = len(audio.drive_channels) + sensors + 1
    a_shot = bytes_of(made.shot.total, channels, "float32", made.config.session.recording)
    require(path, round(1.1 * shots * a_shot), f"{shots} shots of {megabytes(a_shot)}")


def shot_files(path: Path) -> list[Path]:
    """Return the recordings of a run in order, from shot 0 without a gap."""
    files: list[Path] = []
    while True:
        stem = path / "shots" / f"{len(files):04d}"
        found = [file for suffix in (".wav", ".csv") if (file := stem.with_suffix(suffix)).is_file()]
        if not found:
            return files
        files.append(found[0])


class Session:
    """One run, from its first shot or from where it stopped.

    Parameters
    ----------
    folder : RunFolder
    made : Setup
    supervision : Supervision
        Of its line.
    """

    def __init__(self, folder: RunFolder, made: Setup, supervision: Supervision = ALONE) -> None:
        self.folder, self.config, self._made = folder, made.config, made
        self._supervision = supervision
        self.line: Line | None = None
        """While it is open, or after it has failed."""
        self.learner: Learner = made.learner()
        self._judges = [Judge(made, place) for place in made.places]
        self._before: tuple[np.ndarray, np.ndarray] | None = None
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
        return "".join(f"{note}\n" for note in (self._made.note, self._made.plans.note) if note)

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
        OSError : the disk has no room for the shots that are left, or fails; what is recorded stays.
        """
        if self.done >= shots:
            return
        require_room(self.folder.path, self._made, shots - self.done)
        with self._opened() as line:
            self.folder.event("started", {"shot": self.done, "round_trip": line.round_trip, "software": software()})
            try:
                while self.done < shots and not stopped():
                    number = self.done
                    tell(number, self._shoot(line))
            except BaseException as fault:
                self.folder.event("failed", {"shot": self.done, "fault": type(fault).__name__, "text": str(fault)})
                raise
        self.folder.event("stopped" if self.done < shots else "finished", {"shots": self.done})

    @contextmanager
    def _opened(self) -> Iterator[Line]:
        """Open the line, which is `line` until it is closed."""
        self.line = Line(self.config, seconds=self.seconds, on_discard=self._discarded, supervision=self._supervision)
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

    def _shoot(self, line: Line) -> Marks:
        capture = line.emit(self.learner.drive)
        record = recording_of(capture, self.config)
        path = self.folder.shot(self.done).with_suffix(f".{self.config.session.recording}")
        recording.write(path, record)
        return self._learn(record)

    def _learn(self, record: Recording, write: bool = True) -> Marks:
        """Take a recording into the learner, and write what it was worth."""
        number, lines, algorithm = self.done, self.learner.lines, self.learner.algorithm
        purpose, level = algorithm.purpose, algorithm.level
        drive, response = split(record, self.config)
        heard = response, far_field_of(record, self.config)
        self.learner.response[: len(response)] = response
        if self._made.learned.is_far:
            self.learner.far_field[:] = heard[1]
        every = [judge.marks(signals, drive) for judge, signals in zip(self._judges, heard, strict=False)]
        marks = every[self._made.places.index(self._made.judged)]
        self.learner.advance()
        repeatability = self._repeatability(lines)
        if write:
            self._write_lines(number)
            told = dict(zip(self._made.places, every, strict=True))
            gain = algorithm.nominal
            row = row_of(number, purpose, gain, marks, told, record.provenance, repeatability)
            self.folder.quality(row | reduced(level))
            for decision in algorithm.decisions:
                self.folder.event(decision.event, {"shot": number, **decision.fields})
        return marks

    def _repeatability(self, lines: np.ndarray) -> float:
        """Return how much of the response's change since the last shot the model does not explain, dB re response."""
        heard, before = self.learner.heard, self._before
        self._before = lines, heard
        if before is None:
            return float("nan")
        algorithm, law = self.learner.algorithm, self.learner.algorithm.law
        unexplained = (heard - before[1] - algorithm.explained(lines - before[0]))[law.active > 0]
        size = max(float(np.linalg.norm(heard[law.active > 0])), FAINT)
        return float(decibels(float(np.linalg.norm(unexplained)) / size))

    def _write_lines(self, number: int) -> None:
        """Keep gain and certificate of every line beside the shot, (6.12)/(6.18)."""
        algorithm = self.learner.algorithm
        law = algorithm.law
        with sealed(self.folder.path / f"shots/{number:04d}.h5") as file:
            for name, unit, value in (
                ("frequency", "Hz", law.matrix.frequency),
                ("gain", "1", algorithm.gain),
                ("certificate", "1", algorithm.certificate),
                ("error_bound", "m/s^2 s", algorithm.error_bound),
                ("error", "m/s^2 s", law.reference - self.learner.heard),
            ):
                file.create_dataset(name, data=value).attrs["unit"] = unit

    def _resume(self) -> None:
        files = shot_files(self.folder.path)
        judged = len(read_quality(self.folder.path))
        for number, path in enumerate(files):
            self._learn(recording.read(path), write=number >= judged)
        if files:
            self.folder.event("resumed", {"shots": len(files)})

    def _discarded(self, discarded: Discarded) -> None:
        """Keep a recording that nothing is learned from, and say why."""
        kept = keep_discarded(self.folder.path / DISCARDED, f"{self.done:04d}", discarded, self.config)
        fields = {"shot": self.done, "attempt": discarded.attempt, "reason": discarded.reason}
        self.folder.event("discarded", {**fields, "kept": kept.name})
