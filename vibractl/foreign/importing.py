"""Recordings of other software as the folder of a run: written shot by shot, whole or not at all."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.foreign_stream import Signals
from rigkit.kept_files import kept_files
from rigkit.origin import RUN, Origin
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder, read_quality
from vibractl.decibels import FAINT, decibels
from vibractl.foreign.estimate import Estimate
from vibractl.foreign.import_plan import FoundShot, Scanned
from vibractl.foreign.import_verdict import Remark
from vibractl.foreign.judged import silent_lines
from vibractl.foreign.shot_cut import CutShot, cut_shots
from vibractl.judging import Judging
from vibractl.quality import Judge, Marks
from vibractl.quality_table import row_of, summary
from vibractl.run_setup import IMPORTED, MODEL, WISDOM, require_room, with_own_reference
from vibractl.setup import Setup
from vibractl.shot_file import channel_names
from vibractl.spectrum import LineSpectrum

PURPOSE = "imported"


@dataclass(frozen=True)
class Import:
    """What is imported.

    Parameters
    ----------
    scanned : sequence of Scanned
        With the shots that are kept.
    made : Setup, or Judging without a model
    model : Path or None
        The model's file.
    remarks : sequence of Remark
        What is to be said.
    left_out : mapping of int to str
        Why shots are not kept, by their number in the recordings.
    silence : Signals or None
        Of the responses, m/s^2.
    accepted : collection of str
        Keys in which the model may differ.
    is_corrected : bool
        Whether differences of clocks are taken out.
    """

    scanned: Sequence[Scanned]
    made: Setup | Judging
    model: Path | None
    remarks: Sequence[Remark]
    left_out: Mapping[int, str]
    silence: Signals | None
    accepted: Collection[str]
    is_corrected: bool

    @property
    def shots(self) -> list[FoundShot]:
        """All that are kept."""
        return [shot for each in self.scanned for shot in each.shots]


def write_import(path: Path, given: Import, tell: Callable[[int, Marks], None]) -> dict[str, Any]:
    """Make the folder of a run from recordings.

    Parameters
    ----------
    path : Path
        Absent or empty; it is there when it is whole.
    given : Import
    tell : callable
        Called with the number of each shot that is written, from 0, and its marks.

    Returns
    -------
    dict
        As in `summary.json`.

    Raises
    ------
    ValueError : the folder is in use, or a file has changed since it was scanned; nothing is written.
    DiskFault : the disk has no room for it; nothing is written.
    """
    kept, source = with_own_reference(given.made.config)
    files = kept_files(kept, ["reference.signal"])
    require_room(path, given.made, len(given.shots))
    with RunFolder.built(path, rig_file.dump(files.config)) as folder:
        parts = files.take_into(folder)
        if given.model is not None:
            folder.take_in(given.model, MODEL)
            parts.append(MODEL)
        if source is not None:
            folder.take_in(source, kept.reference.signal)
            parts.append(kept.reference.signal)
        if given.made.plans.wisdom:
            folder.write(WISDOM, given.made.plans.wisdom)
        folder.event("importing", {"files": _files(given), "software": software()})
        for remark in given.remarks:
            folder.event("warning" if remark.is_warning else "remark", {"text": remark.text})
        for number, reason in given.left_out.items():
            folder.event("discarded", {"found": number, "reason": reason})
        _Writer(folder, given).write(tell)
        figures = summary(read_quality(folder.path), given.made)
        figures["warnings"] = [remark.text for remark in given.remarks if remark.is_warning]
        folder.summarise(figures)
        folder.event("finished", {"shots": len(given.shots)})
        origin = Origin.of(IMPORTED, files.config, {name: folder.path / name for name in parts})
        measured = min(each.recorded.response.path.stat().st_mtime for each in given.scanned)
        dated = replace(origin, measured=datetime.fromtimestamp(measured, UTC).isoformat(), finished=now())
        folder.write(RUN, dated.accepting(given.accepted).text)
    return figures


class _Writer:
    """Judges and writes shot after shot."""

    def __init__(self, folder: RunFolder, given: Import) -> None:
        self._folder, self._given, self._made = folder, given, given.made
        self._judge = Judge(given.made)
        self._repeats = _Repeats(given.made) if isinstance(given.made, Setup) else None
        self._silent: np.ndarray | None = None
        if given.silence is not None:
            self._say_silence(given.silence)

    def write(self, tell: Callable[[int, Marks], None]) -> None:
        """Write all shots."""
        number = 0
        for scanned in self._given.scanned:
            correction = correction_of(scanned) if self._given.is_corrected else None
            for cut in cut_shots(scanned, self._made.shot, correction):
                tell(number, self._written(number, cut))
                number += 1

    def _written(self, number: int, cut: CutShot) -> Marks:
        record = self._record(cut)
        recording.write(self._folder.shot(number).with_suffix(f".{self._made.config.session.recording}"), record)
        width = cut.drive.shape[1]
        drive, response = record.data[:, :width], record.data[:, width:]
        error = self._judge.error(response)
        marks = self._judge.marks_of(error, drive)
        place = self._made.places[0]
        repeatability = float("nan") if self._repeats is None else self._repeats.follow(drive, error)
        row = row_of(number, PURPOSE, float("nan"), marks, {place: marks}, record.provenance, repeatability)
        self._folder.quality(row)
        found = {name: value for name, value in figures_of(cut.found, self._made).items() if value is not None}
        self._folder.event("shot", {"shot": number, **found, "objective": marks.reason})
        self._say_noise(number, marks, error)
        return marks

    def _record(self, cut: CutShot) -> Recording:
        drives, responses = channel_names(self._made.config)
        placed, first = cut.found.placed, self._given.shots[0].placed
        late, off = placed.delay, placed.fraction - first.fraction
        about = {"rig": self._made.config.rig.name, "recorded_in": cut.found.recorded.name}
        about |= {
            "residual": repr(0.0 if self._given.is_corrected else float(off)),
            "quality": repr(cut.found.seen.likeness),
        }
        about |= {} if late is None else {"delay": repr(float(late.value))}
        units = ("V",) * len(drives) + ("m/s^2",) * len(responses)
        data = np.column_stack((cut.drive, cut.response)).astype(np.float32)
        return Recording((*drives, *responses), units, self._made.config.audio.rate, data, about)

    def _say_silence(self, silence: Signals) -> None:
        """Say how the sensors without a drive stand to the limit."""
        self._silent = silent_lines(self._judge, silence, self._made.shot)
        over = decibels(self._silent[self._judge.judged] / self._judge.limit).max(axis=0)
        self._folder.event("silence", {"recording": str(silence.path), "over_the_limit_db": over.tolist()})

    def _say_noise(self, number: int, marks: Marks, error: np.ndarray) -> None:
        """Say where the worst line of a shot is as loud without a drive."""
        if self._silent is None:
            return
        side = int(np.argmax(marks.worst_line_db))
        line = int(np.argmin(np.abs(self._judge.frequency - marks.worst_line_hz[side])))
        size = abs(self._judge.lines(error)[line, side])
        if self._silent[line, side] > 10 ** (-3 / 20) * size:
            text = "the worst bin is as loud in silence: it is hum or noise, and not emitted"
            self._folder.event("remark", {"shot": number, "text": text})


class _Repeats:
    """Follows how much of the responses' changes a model does not explain."""

    def __init__(self, made: Setup) -> None:
        law, step = made.law, made.config.learning.decimation
        lines = law.matrix.frequency
        rate, frames = made.shot.rate / step, made.shot.frames // step
        self._spectrum = LineSpectrum(frames, len(law.outputs), rate, (lines[0], lines[-1]), made.plans)
        self._learner, self._made = made.learner(), made
        self._before: tuple[np.ndarray, np.ndarray] | None = None

    def follow(self, drive: np.ndarray, error: np.ndarray) -> float:
        """Return what of the change since the last shot is not explained, dB re response; NaN for the first one."""
        law, algorithm = self._made.law, self._learner.algorithm
        heard = law.reference - self._spectrum.lines(law.window * error)
        lines = self._learner.lines_of(drive[self._made.shot.window].astype(float))
        before, self._before = self._before, (lines, heard)
        if before is None:
            return float("nan")
        unexplained = (heard - before[1] - algorithm.belief.explained(lines - before[0]))[law.active > 0]
        return float(
            decibels(float(np.linalg.norm(unexplained)) / max(float(np.linalg.norm(heard[law.active > 0])), FAINT))
        )


def correction_of(scanned: Scanned) -> Estimate:
    """Return by how much the recorder's clock is faster, ppm; nothing where that cannot be told from nothing."""
    clock = scanned.clock
    return clock if clock is not None and clock.is_told else Estimate(0.0, 0.0)


def figures_of(shot: FoundShot, made: Setup | Judging) -> dict[str, Any]:
    """Return what other programs read of a shot that was found."""
    seen, placed = shot.seen, shot.placed
    return {
        "response": shot.recorded.name,
        "drive": str(shot.recorded.drive.path),
        "begins_s": (placed.response + placed.fraction) / made.shot.rate,
        "correlation": seen.likeness,
        "delay": None if placed.delay is None else placed.delay.value,
        "delay_error": None if placed.delay is None else placed.delay.error,
        "delay_removed": placed.removed,
        "clock_ppm": None if seen.clock is None else seen.clock.value,
        "clock_error": None if seen.clock is None else seen.clock.error,
        "inverted": [sign.is_inverted if sign.is_sure else None for sign in seen.polarity],
        "polarity_confidence": [sign.confidence for sign in seen.polarity],
    } | {
        f"{kind}_{name}": None if each is None else value
        for kind, each in (("drives", seen.drives), ("responses", seen.responses))
        for name, value in (
            ("exchanged", each and each.is_other and each.is_sure), ("confidence", each and each.confidence)
        )
    }  # fmt: skip


def _files(given: Import) -> list[str]:
    both = [path for each in given.scanned for path in (each.recorded.drive.path, each.recorded.response.path)]
    return [str(path) for path in dict.fromkeys(both)]
