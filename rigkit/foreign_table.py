"""Tables of anybody's as signals: CSV, TSV and text, names and units from the head, the rate from a column of time."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks import csv_file
from ctlblocks.recording import RecordingError
from rigkit.even_time import SECONDS, EvenTime, is_time
from rigkit.foreign_stream import Signals
from rigkit.table_rows import Cells, cells_of, is_number, lines_of, parsed, text_blocks

SUFFIXES = (".csv", ".tsv", ".txt", ".dat")
LOOKED_AT = 1000
"""Rows by which it is found whether numbers have a decimal comma."""


@dataclass(frozen=True)
class _Head:
    """What stands above the rows.

    Parameters
    ----------
    names, units : tuple of str
    first : int
        Number of the line with the first row of numbers.
    cells : Cells
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    cells: Cells


def table_signals(path: Path, rate: float | None) -> Signals:
    """Open a table; its columns are "channel_1", "channel_2", ... where it names none.

    Parameters
    ----------
    path : Path
    rate : float or None, samples/s
        Where the table has neither a column of time nor this program's first line.

    Raises
    ------
    RecordingError : no table, no rate, or a column of time that does not rise evenly.
    """
    with path.open("rb") as file:
        start = file.readline(200).removeprefix(b"\xef\xbb\xbf")
    if start.startswith((b"# {", b"#{")):
        return _own(path)
    head = _head(path)
    columns = tuple(range(head.cells.width))
    timed = [number for number in columns if is_time(head.names[number])]
    if timed:
        found, frames = _timed(path, head, timed[0])
    elif rate is None:
        raise RecordingError(f"{path}: does not say its rate: give that, or a column of time in s")
    else:
        found, frames = rate, None
    return Signals(
        path, head.names, head.units, found, frames, lambda: (rows for _, rows in _rows(path, head)), columns
    )


def _own(path: Path) -> Signals:
    """Open a table that this program wrote: its first line says rate, length and precision."""
    first, head = itertools.islice(itertools.chain(_texts(path), [(2, "")]), 2)
    try:
        said = csv_file.preamble(first[1])
    except ValueError as fault:
        raise RecordingError(f"{path}: {fault}") from None
    names, units = _named(cells_of(head[1], ","))
    if said["dtype"] not in ("float32", "float64"):
        raise RecordingError(f"{path}: row 1 says samples are {said['dtype']!r}, must be float32 or float64")
    if said["frames"] is not None:
        _refuse_cut_off(path)
    layout = _Head(names, units, 3, Cells(",", len(names)))

    def source() -> Iterator[np.ndarray]:
        for _, rows in _rows(path, layout):
            with np.errstate(over="ignore"):
                yield rows.astype(said["dtype"]).astype(float)

    columns = tuple(range(len(names)))
    return Signals(path, names, units, said["rate"], said["frames"], source, columns, said["provenance"])


def _head(path: Path) -> _Head:
    """Read what stands above the rows of numbers, and how those are written."""
    rows = list(itertools.islice(lines_of(path), LOOKED_AT))
    if len(rows) < 2:
        raise RecordingError(f"{path}: has {len(rows)} rows, must have at least 2")
    between = _separator(rows[0][1])
    first = cells_of(rows[0][1], between)
    decimal = _decimal(rows, between)
    cells = Cells(between, len(first), decimal)
    has_names = not all(cells.number(cell) is not None for cell in first)
    if not has_names:
        names, units = tuple(f"channel_{number + 1}" for number in range(len(first))), ("1",) * len(first)
        return _Head(names, units, rows[0][0], cells)
    if any(is_number(cell) and not cell.isdecimal() for cell in first):
        raise RecordingError(f"{path}: row {rows[0][0]} is {rows[0][1][:60]!r}, must be names, or numbers")
    return _Head(*_named(first), rows[1][0], cells)


def _rows(path: Path, head: _Head) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Read the rows of numbers in blocks: their places in the file and their values, shape (rows, columns)."""
    for first, block in text_blocks(path):
        skipped = head.first - first
        if skipped > 0:
            block = block.split(b"\n", skipped)[-1] if block.count(b"\n") > skipped else b""
        if block.strip():
            yield parsed(path, max(first, head.first), block, head.cells)


def _timed(path: Path, head: _Head, column: int) -> tuple[float, int]:
    """Return rate and frames by a column of time: reads all of the table once."""
    name, unit = head.names[column], head.units[column]
    if unit not in SECONDS:
        raise RecordingError(f"{path}: {name!r} is in {unit}, must be in {', '.join(SECONDS)}")
    time = EvenTime(f"{path}: {name!r}", SECONDS[unit], "row")
    for places, rows in _rows(path, head):
        time.follow(places, rows[:, column])
    if time.frames < 2:
        raise RecordingError(f"{path}: has {time.frames} row of numbers, must have at least 2 to tell the rate")
    return time.rate(), time.frames


def _separator(line: str) -> str | None:
    """Return what stands between cells, None for spaces."""
    return next((mark for mark in (";", "\t", ",") if mark in line), None)


def _decimal(rows: Sequence[tuple[int, str]], between: str | None) -> str:
    """Return the mark between units and tenths: the first one that a row of numbers has."""
    if between in (",", None):
        return "."
    for _, line in rows:
        cells = cells_of(line, between)
        if all(is_number(cell.replace(",", ".")) for cell in cells):
            if any("," in cell for cell in cells):
                return ","
            if any("." in cell for cell in cells):
                return "."
    return "."


def _named(heads: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of cells as "force [N]" or "force (N)"."""
    parts = [head.strip().removesuffix("]").partition("[") for head in heads]
    return tuple(name.strip() for name, _, _ in parts), tuple(unit.strip() or "1" for _, _, unit in parts)


def _texts(path: Path) -> Iterator[tuple[int, str]]:
    """Read the lines of a file, whatever they are."""
    for first, block in text_blocks(path):
        yield from enumerate(block.decode(errors="replace").split("\n")[:-1], start=first)


def _refuse_cut_off(path: Path) -> None:
    with path.open("rb") as file:
        file.seek(-1, 2)
        if file.read(1) not in b"\r\n":
            raise RecordingError(f"{path}: the last row has no end of a line, it is cut off")
