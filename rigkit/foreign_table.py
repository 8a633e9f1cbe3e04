"""Tables of anybody's as signals: CSV, TSV, text and LabVIEW's; the rate from their head or a column of time."""

from codecs import BOM_UTF8
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.even_time import STEADY, EvenTime, seconds_of
from rigkit.foreign_stream import Signals
from rigkit.table_head import Head, own_head, plain_head
from rigkit.table_labview import START, labview_head
from rigkit.table_rows import parsed, text_blocks

SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".lvm")


def table_signals(path: Path, rate: float | None, may_miss: bool = False) -> Signals:
    """Open a table; its columns are "channel_1", "channel_2", ... where it names none.

    Parameters
    ----------
    path : Path
    rate : float or None, samples/s
        Where the table does not say it.
    may_miss : bool, optional
        Whether samples may be missing: cells that are empty, or nan.

    Raises
    ------
    RecordingError : no table, no rate or two, or a column of time that does not rise evenly.
    """
    with path.open("rb") as file:
        start = file.read(40).removeprefix(BOM_UTF8)
    if start.startswith((b"# {", b"#{")):
        head = own_head(path)
    elif start.startswith(START):
        head = labview_head(path)
    else:
        head = plain_head(path)
    found, frames = _rate(path, head, rate)
    head = replace(head, cells=replace(head.cells, may_miss=may_miss))

    def source() -> Iterator[np.ndarray]:
        for _, rows in _rows(path, head):
            if head.precision == "float32":
                with np.errstate(over="ignore"):
                    rows = rows.astype(np.float32).astype(float)
            yield rows

    columns = tuple(range(len(head.names)))
    return Signals(path, head.names, head.units, found, frames, source, columns, head.provenance)


def _rate(path: Path, head: Head, rate: float | None) -> tuple[float, int | None]:
    """Return rate and, where it is known, the number of frames: by what is said, by time, or as given."""
    timed = [column for column, name in enumerate(head.names) if seconds_of(name, "1") is not None]
    by_time, frames = _timed(path, head, timed[0]) if timed else (None, head.frames)
    said = head.rate
    if said is None:
        said = by_time if by_time is not None else rate
    if said is None:
        raise RecordingError(f"{path}: does not say its rate: give that, or a column of time in s")
    if not head.slack:
        if by_time is not None and not abs(by_time - said) <= STEADY * abs(said):
            raise RecordingError(
                f"{path}: says {said:.9g} samples/s, its column {head.names[timed[0]]!r} {by_time:.9g}: they must agree"
            )
        return said, frames
    better = by_time if by_time is not None else rate
    if better is not None and abs(1 / better - 1 / said) <= head.slack + STEADY / said:
        return better, frames
    if by_time is not None:
        raise RecordingError(f"{path}: Delta_X says {said:.9g} samples/s, X_Value {by_time:.9g}: they must agree")
    return said, frames


def _timed(path: Path, head: Head, column: int) -> tuple[float, int]:
    """Return rate and frames by a column of time: reads all of the table once."""
    name, unit = head.names[column], head.units[column]
    scale = seconds_of(name, unit)
    if scale is None:
        raise RecordingError(f"{path}: {name!r} is in {unit}, must be in s, ms, us or ns")
    time = EvenTime(f"{path}: {name!r}", scale, "row")
    for places, rows in _rows(path, head, column):
        time.follow(places, rows[:, 0])
    return time.rate(), time.frames


def _rows(path: Path, head: Head, column: int | None = None) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Read the rows of numbers in blocks: their places in the file and their values, shape (rows, columns).

    Of one `column` alone, where that is all that is wanted.
    """
    for first, block in text_blocks(path):
        skipped = head.first - first
        if skipped > 0:
            block = block.split(b"\n", skipped)[-1] if block.count(b"\n") > skipped else b""
        if block.strip():
            yield parsed(path, max(first, head.first), block, head.cells, column)
