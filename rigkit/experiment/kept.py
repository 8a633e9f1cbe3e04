"""A run of an experiment in its folder: made, run, read back, reported and replayed."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import atomic
from rigkit import config as rig_file
from rigkit.disk_space import require
from rigkit.experiment.kind import Experiment, Kind
from rigkit.experiment.runner import KILLED, STOPPED, Conduct, unheard
from rigkit.experiment.succession import perform, run_in_memory
from rigkit.json_text import json_text
from rigkit.kept_files import kept_files
from rigkit.report import Fact
from rigkit.run_folder import SUMMARY, RunFolder, make_whole, read_events
from rigkit.run_origin import keep_origin
from rigkit.stop import Stopped

EARLY, GAPS = "ended_early", "recordings_with_gaps"
"""Among the figures of a run, where there is something to be said: reasons by part; recordings judged to a gap."""


def early_facts(figures: Mapping[str, Any]) -> list[Fact]:
    """Return facts for a report: why a run ended early, and that recordings have gaps."""
    facts = [
        Fact(f"Ended early{f', {part}' if part else ''}", reason, passed=False)
        for part, reason in figures.get(EARLY, {}).items()
    ]
    if broken := figures.get(GAPS):
        facts.append(Fact("Judged up to the first gap", ", ".join(broken), passed=False))
    return facts


def nothing_more(folder: RunFolder) -> list[str]:  # noqa: ARG001 (a taker's argument)
    """Take no further file into the folder of a run."""
    return []


def create(
    path: Path,
    kind: Kind,
    config: BaseModel,
    experiment: Experiment,
    take_more: Callable[[RunFolder], list[str]] = nothing_more,
    accept: Sequence[str] = (),
) -> RunFolder:
    """Make the folder of a new run, with copies of the files that its rig file names.

    Parameters
    ----------
    path : Path
        Absent, or an empty folder.
    kind : Kind
    config : Section
        The whole rig file.
    experiment : Experiment
    take_more : callable(RunFolder) -> list of str
        Takes further files into the folder, and returns their names there.
    accept : sequence of str
        Keys whose difference has been accepted.

    Raises
    ------
    FolderInUseError : something is there already.
    DiskFault : there is no room for its recordings.
    """
    require(path, experiment.room, "the recordings")
    files = kept_files(config, kind.apart)
    with RunFolder.filled(path, rig_file.dump(files.config)) as folder:
        parts = [*take_more(folder), *files.take_into(folder)]
        keep_origin(folder, kind.name, files.config, parts, accept, experiment.designed)
    return folder


def run(
    folder: RunFolder, kind: Kind, experiment: Experiment, conduct: Conduct, png: Path | None = None
) -> tuple[dict[str, str], dict[str, Any]]:
    """Run an experiment, recorded as it goes; return why parts ended before their end, by name, and its figures.

    Parameters
    ----------
    folder : RunFolder
    kind : Kind
    experiment : Experiment
    conduct : Conduct
    png : Path, optional
        Where its figures are to be as PNG files.

    Raises
    ------
    Stopped : before there was anything to judge.
    Whatever ends a part: what was recorded until then is kept, with a report where it can be judged.
    """
    try:
        reasons = perform(folder, experiment.parts(folder.event, conduct.stopped), experiment.about, conduct)
    except Exception:
        with suppress(Exception):  # what has ended the run is what is told
            _written(folder.path, kind, png, is_reported=kind.reports_early)
        raise
    with _judging(reasons, f"; what is recorded is in {folder.path}/"):
        return reasons, _written(folder.path, kind, png, is_reported=not reasons or kind.reports_early)


def in_memory(experiment: Experiment, conduct: Conduct) -> tuple[dict[str, str], dict[str, Any]]:
    """Run an experiment without a folder; return why parts ended before their end, by name, and its figures."""
    reasons, records = run_in_memory(experiment.parts(unheard, conduct.stopped), conduct)
    with _judging(reasons, ""):
        return reasons, experiment.figures(records)


def records_of(path: Path, part: str = "") -> dict[str, Recording]:
    """Return what is recorded in a run's folder, by track; of one with gaps, what is ahead of the first.

    Parameters
    ----------
    path : Path
    part : str
        Only what is recorded of that part; of all without.
    """
    files = [file for file in recordings(path) if not _goes_on(file) and file.stem.startswith(part)]
    return {file.stem: recording.read(file) for file in files}


def recordings(path: Path) -> list[Path]:
    """Return the recordings that lie in a run folder, whatever has made them."""
    return [file for file in sorted(path.iterdir()) if file.suffix == ".wav" or _is_recorded_csv(file)]


def _is_recorded_csv(file: Path) -> bool:
    if file.suffix != ".csv":
        return False
    with file.open("rb") as content:
        return content.read(1) == b"#"


def reported(path: Path, kind: Kind, png: Path | None = None) -> dict[str, Any]:
    """Write the report of a run again; return its figures.

    Parameters
    ----------
    path : Path
        Of its folder.
    kind : Kind
    png : Path, optional
        Where its figures are to be as PNG files.

    Raises
    ------
    ValueError : nothing that could be judged is recorded.
    """
    make_whole(path)
    return _written(path, kind, png, is_reported=True)


def told(path: Path, kind: str) -> dict[str, dict[str, Any]]:
    """Return the last event of a kind since each part began last, by the name of the part.

    Parameters
    ----------
    path : Path
        Of a run's folder.
    kind : str
        The event.
    """
    found: dict[str, dict[str, Any]] = {}
    for event in read_events(path):
        if "part" not in event:
            continue
        if event["event"] == "started":
            found.pop(event["part"], None)
        if event["event"] == kind:
            found[event["part"]] = event
    return found


@contextmanager
def _judging(reasons: Mapping[str, str], where: str) -> Iterator[None]:
    """Judge a run: one that was stopped before there was anything to judge is `Stopped`, and no error.

    Of one that a fault has ended before, that is told.
    """
    try:
        yield
    except ValueError as fault:
        if STOPPED in reasons.values():
            raise Stopped(f"{STOPPED}: {fault}{where}") from None
        for part, reason in reasons.items():
            raise ValueError(f"{ended_early(part, reason)}{where}") from None
        raise


def ended_early(part: str, reason: str) -> str:
    """Return in words that a part has ended before its end."""
    return f"{part}: {reason}" if part else reason


def _written(path: Path, kind: Kind, png: Path | None, *, is_reported: bool) -> dict[str, Any]:
    """Write summary, and report where that is wanted, of what is in a run's folder; return its figures."""
    records = records_of(path)
    experiment = kind.read(path, records, ())
    figures = {**experiment.figures(records), **_early(path), **_gaps(path)}
    atomic.write(path / SUMMARY, f"{json_text(figures, indent=2)}\n")
    if is_reported:
        experiment.report(path, records, figures, png)
    return figures


def _early(path: Path) -> dict[str, Any]:
    """Return why parts have ended before their end, by name, where some have."""
    ends = told(path, "ended")
    reasons = {part: ends[part]["reason"] if part in ends else KILLED for part in told(path, "started")}
    early = {part: reason for part, reason in reasons.items() if reason}
    return {EARLY: early} if early else {}


def _gaps(path: Path) -> dict[str, Any]:
    """Return which recordings have gaps: what comes after the first one is judged by nothing."""
    broken = sorted({track_of(file) for file in recordings(path) if _goes_on(file)})
    return {GAPS: broken} if broken else {}


def track_of(file: Path) -> str:
    """Return the name of the track that a recording is of, or goes on with."""
    return file.stem.rpartition("-")[0] if _goes_on(file) else file.stem


def _goes_on(file: Path) -> bool:
    """Whether a recording follows a gap in another: its name ends in a dash and four digits."""
    stem, dash, number = file.stem.rpartition("-")
    return bool(dash) and len(number) == 4 and number.isdecimal() and file.with_stem(stem).exists()
