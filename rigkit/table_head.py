"""What stands above the rows of a table: names and units of its columns, how its numbers are written, its rate."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ctlblocks import csv_file
from ctlblocks.recording import RecordingError
from rigkit.column_titles import names_and_units
from rigkit.table_rows import Cells, as_text, cells_of, is_number, lines_of, text_blocks

LOOKED_AT = 1000
"""Rows by which it is found whether numbers have a decimal comma."""
LONGEST_UNIT = 16
"""Characters in a row of units."""


@dataclass(frozen=True)
class Head:
    """What stands above the rows.

    Parameters
    ----------
    names, units : tuple of str
    first : int
        Number of the line from which rows of numbers are looked for.
    cells : Cells
    rate : float or None, samples/s
        Where it is said above.
    slack : float, s
        By which the period that is said may differ from 1 / `rate`: it is rounded.
    frames : int or None
        Where it is said above.
    precision : "float32" or "float64"
        In which the numbers were written.
    provenance : mapping of str to str
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    cells: Cells
    rate: float | None = None
    slack: float = 0.0
    frames: int | None = None
    precision: Literal["float32", "float64"] = "float64"
    provenance: Mapping[str, str] = field(default_factory=dict)


def own_head(path: Path) -> Head:
    """Read the head of a table that this program wrote: its first line says rate, length and precision.

    Parameters
    ----------
    path : Path

    Raises
    ------
    RecordingError : a first line that says something else, or a last row that is cut off.
    """
    (_, first), (_, second) = itertools.islice(itertools.chain(lines_above(path), [(2, ""), (3, "")]), 2)
    try:
        said = csv_file.preamble(first)
    except ValueError as fault:
        raise RecordingError(f"{path}: {fault}") from None
    if said["dtype"] not in ("float32", "float64"):
        raise RecordingError(f"{path}: row 1 says samples are {said['dtype']!r}, must be float32 or float64")
    if said["frames"] is not None:
        _refuse_cut_off(path)
    names, units = names_and_units(cells_of(second, ","))
    about = said["frames"], said["dtype"], said["provenance"]
    return Head(names, units, 3, Cells(",", len(names)), said["rate"], 0.0, *about)


def plain_head(path: Path) -> Head:
    """Read the head of any other table: a row of names or none, and a row of units below it or none.

    Parameters
    ----------
    path : Path

    Raises
    ------
    RecordingError : no table.
    """
    rows = list(itertools.islice(lines_of(path), LOOKED_AT))
    if len(rows) < 2:
        raise RecordingError(f"{path}: has {len(rows)} rows, must have at least 2")
    (row, line), (below, _) = rows[:2]
    between, decimal = _writing(rows)
    first = cells_of(line, between)
    cells = Cells(between, len(first), decimal)
    if all(cells.number(cell) is not None for cell in first):
        return Head(tuple(f"channel_{n + 1}" for n in range(len(first))), ("1",) * len(first), row, cells)
    if any(is_number(cell) and not cell.isdecimal() for cell in first):
        raise RecordingError(f"{path}: row {row} is {line[:60]!r}, must be names, or numbers")
    names, units = names_and_units(first)
    second = cells_of(rows[1][1], between)
    if set(units) != {"1"} or not _are_units(second, len(first)):
        return Head(names, units, below, cells)
    if len(rows) < 3:
        raise RecordingError(f"{path}: has names and units, but no row of numbers")
    return Head(names, tuple(cell.strip("[]() ") or "1" for cell in second), rows[2][0], cells)


def lines_above(path: Path) -> Iterator[tuple[int, str]]:
    """Read the lines of a file, whatever they are, with their numbers; RecordingError where one is not UTF-8."""
    for first, block in text_blocks(path):
        yield from enumerate(as_text(path, first, block).removesuffix("\n").split("\n"), start=first)


def _writing(rows: Sequence[tuple[int, str]]) -> tuple[str | None, str]:
    """Return what stands between cells, None for spaces, and before the tenths, as the first row that tells has it."""
    head = rows[0][1]
    between = next((mark for mark in (";", "\t", ",") if mark in head), None)
    if between == "," and all(_with_comma(cell) for _, line in rows for cell in cells_of(line, None)):
        if any(len(cells_of(line, None)) > 1 for _, line in rows):
            return None, ","  # "0,1 0,2"
    if between == ",":
        return ",", "."
    for _, line in rows:
        cells = cells_of(line, between)
        if all(_with_comma(cell) or is_number(cell) for cell in cells):
            if between is None and len(cells) == 1:
                continue  # "1,5" may be two cells
            if any("," in cell for cell in cells):
                return between, ","
            if any("." in cell for cell in cells):
                return between, "."
    return between, "."


def _with_comma(cell: str) -> bool:
    return "." not in cell and is_number(cell.replace(",", ".", 1))


def _are_units(cells: Sequence[str], width: int) -> bool:
    """Whether a row is one of units: short words, at least one, and no number."""
    words = [cell.strip("[]() ") for cell in cells]
    short = all(len(word) <= LONGEST_UNIT and not is_number(word.replace(",", ".")) for word in words)
    return len(cells) == width and any(words) and short


def _refuse_cut_off(path: Path) -> None:
    with path.open("rb") as file:
        file.seek(-1, 2)
        if file.read(1) not in (b"\r", b"\n"):
            raise RecordingError(f"{path}: the last row has no end of a line, it is cut off")
