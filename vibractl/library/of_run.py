"""What a run has learned, as an entry of the library: its shots are learned from again, up to the last."""

from collections.abc import Mapping
from pathlib import Path

from ctlblocks import recording
from rigkit import config as rig_file
from rigkit.provenance import now, software
from rigkit.run_folder import read_events, read_quality
from vibractl.library.entry import Entry
from vibractl.library.fit import reference_hash, wiring
from vibractl.quality import PASS
from vibractl.quality_table import is_reduced, prefix_of
from vibractl.run_setup import setup_of, shot_files
from vibractl.setup import Setup
from vibractl.shot_file import far_field_of, split

Rows = list[dict[str, str]]


def entry_of(path: Path, shot: int | None, tags: Mapping[str, str]) -> Entry:
    """Make an entry from a run.

    Parameters
    ----------
    path : Path
        Run folder.
    shot : int, optional
        Whose drive is kept; else the last that met the objective, or that of the least error.
    tags : mapping of str

    Returns
    -------
    Entry
        Without a name; its model is what was believed after the last shot.

    Raises
    ------
    ValueError : no such shot, or one that was no drive for the whole reference.
    """
    made, files = setup_of(path), shot_files(path)
    rows = read_quality(path)[: len(files)]
    number = _chosen(path, rows, shot)
    learner = made.learner()
    for place, file in enumerate(files[: len(rows)]):
        record = recording.read(file, rate=made.shot.rate)
        if len(record.data) != made.shot.total:
            raise ValueError(f"{file}: {len(record.data)} samples, must be {made.shot.total}")
        drive, response = split(record, made.config)
        if made.learned.is_far:
            learner.far_field[:] = far_field_of(record, made.config)
        learner.played(drive)
        if place == number:
            lines = learner.lines.copy()
        learner.response[: len(response)] = response
        learner.advance()
        if place == number:
            error = made.law.reference - learner.heard
    algorithm = learner.algorithm
    about = _about(path, made, rows[number])
    frequency, reference = made.law.matrix.frequency, made.law.reference
    return Entry(frequency, lines, reference, error, algorithm.belief.response, algorithm.belief.variance, about, tags)


def _chosen(path: Path, rows: Rows, shot: int | None) -> int:
    """Return the number of the shot whose drive is kept."""
    whole = {int(row["shot"]): row for row in rows if not is_reduced(row) and row.get("purpose") != "reidentify"}
    if shot is not None and shot not in whole:
        there = shot in [int(row["shot"]) for row in rows]
        reason = "was emitted to check or to reidentify" if there else "is not recorded"
        raise ValueError(f"{path}: shot {shot} {reason}, must be one of {_ranges(sorted(whole))}")
    if shot is not None:
        return shot
    if not whole:
        raise ValueError(f"{path}: no shot was learned from")
    met = [number for number, row in whole.items() if row["verdict"] == PASS]
    return met[-1] if met else min(whole, key=lambda number: _worst(whole[number], f"{prefix_of(rows)}error_db_"))


def _worst(row: Mapping[str, str], prefix: str) -> float:
    """Return the largest of a row's figures over the sides."""
    return max(float(text) for key, text in row.items() if key.startswith(prefix) and text)


def _about(path: Path, made: Setup, row: Mapping[str, str]) -> dict[str, str]:
    events, prefix = read_events(path), prefix_of([dict(row)])
    told = {event["software"] for event in events if "software" in event}
    return {
        "name": "",
        "rig": made.config.rig.name,
        "config": rig_file.dump(made.config),
        "wiring": wiring(made.config),
        "reference_text": made.reference.text,
        "reference_hash": reference_hash(made.reference, made.config.audio.rate),
        "run": str(path.resolve()),
        "shot": row["shot"],
        "date": events[-1]["time"] if events else now(),
        "software": " | ".join(sorted(told)) or software(),
        "law": made.config.learning.law,
        "unit": made.learned.unit,
        "met": row["verdict"],
        "worst_line_db": f"{_worst(row, f'{prefix}worst_line_db_'):.2f}",
        "error_db": f"{_worst(row, f'{prefix}error_db_'):.2f}",
        "objective_db": f"{made.config.quality.objective:g}",
    }


def _ranges(numbers: list[int]) -> str:
    if not numbers:
        return "none"
    return f"{numbers[0]} to {numbers[-1]}" if numbers == list(range(numbers[0], numbers[-1] + 1)) else str(numbers)
