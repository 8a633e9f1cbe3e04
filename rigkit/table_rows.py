"""Rows of numbers in a text file, block by block: at once where a block is clean, else cell by cell."""

import csv
import re
from codecs import BOM_UTF8
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.number_rows import number_rows
from rigkit.text_file import TextFault, decoded

BLOCK = 2**21
"""Bytes that are read at once."""
LONGEST_LINE = 2**20
"""Bytes of a line: of 40,000 columns."""
COMMENT = ("#", "%")
"""What a line begins with that is none."""


@dataclass(frozen=True)
class Cells:
    """How the rows of a table are written.

    Parameters
    ----------
    between : str or None
        What stands between two cells; None for spaces.
    width : int
        Cells of a row.
    decimal : str
        "." or, where `between` is no comma, ",".
    open_ended : bool
        Whether a row may begin and end with empty cells, and end with words.
    may_miss : bool
        Whether a cell may be empty or nan, which is a sample that is missing.
    """

    between: str | None
    width: int
    decimal: str = "."
    open_ended: bool = False
    may_miss: bool = False

    def split(self, line: str) -> list[str]:
        """Return the cells of a line."""
        found = cells_of(line, self.between)
        if self.open_ended and len(found) == self.width + 1 and self.number(found[-1]) is None:
            return found[:-1]
        return found

    def number(self, cell: str) -> float | None:
        """Return the number in a cell, None where there is none."""
        if self.decimal == ",":
            cell = "?" if "." in cell else cell.replace(",", ".")
        return float(cell) if is_number(cell) else None


def is_number(cell: str) -> bool:
    """Whether a cell holds a number with a decimal point, or is nan or inf."""
    try:
        float(cell)
    except ValueError:
        return False
    return cell.isascii() and cell.isprintable() and "_" not in cell  # float() takes 1_0, and digits of every script


def cells_of(line: str, between: str | None) -> list[str]:
    """Return the cells of a line, without the spaces around them."""
    if between is None:
        return re.split("[ \t]+", line.strip(" \t"))  # and not all that str.split() takes for a space
    try:
        return [cell.strip(" \t") for cell in next(csv.reader([line], delimiter=between, strict=True))]
    except csv.Error:  # a cell of more than 128 KiB, or quotes within one
        return [line]


def text_blocks(path: Path) -> Iterator[tuple[int, bytes]]:
    r"""Read a file in blocks of whole lines that end in \n: the number of its first line, from 1, and the block.

    Raises
    ------
    RecordingError : a line is longer than `LONGEST_LINE`.
    """
    number, rest = 1, b""
    with path.open("rb") as file:
        file.seek(len(BOM_UTF8) if file.read(len(BOM_UTF8)) == BOM_UTF8 else 0)
        while fresh := file.read(BLOCK):
            if fresh.endswith(b"\r"):
                fresh += file.read(1)
            if b"\r" in fresh:
                fresh = fresh.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
            whole, end, rest = (rest + fresh).rpartition(b"\n")
            if len(rest) > LONGEST_LINE:
                row = number + whole.count(b"\n") + len(end)
                raise RecordingError(f"{path}: row {row} is no row of a table: more than {LONGEST_LINE} bytes")
            if end:
                yield number, whole + end
                number += whole.count(b"\n") + 1
    if rest:
        yield number, rest + b"\n"


def lines_of(path: Path) -> Iterator[tuple[int, str]]:
    """Read the lines of a file that are not empty and no comment, with their numbers.

    Raises
    ------
    RecordingError : bytes that are not UTF-8, or a line without an end.
    """
    for first, block in text_blocks(path):
        yield from _kept(path, first, block)


def parsed(
    path: Path, first: int, block: bytes, cells: Cells, column: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows of a block: their numbers in the file, shape (rows,), and their values, shape (rows, width).

    Parameters
    ----------
    path : Path
        For errors.
    first : int
        Number of the block's first line.
    block : bytes
    cells : Cells
    column : int, optional
        The only one whose values, shape (rows, 1), are wanted.

    Raises
    ------
    RecordingError : it names the row, the column and the cell.
    """
    if cells.open_ended and cells.between:
        block = re.sub(rb"^%b|%b+$" % (cells.between.encode(), cells.between.encode()), b"", block, flags=re.MULTILINE)
    wanted = range(cells.width) if column is None else range(column, column + 1)
    data = number_rows(block.rstrip(b"\n") + b"\n", cells.between, cells.width, cells.decimal, wanted)
    if data is not None:
        return np.arange(first, first + len(data)), data
    rows, numbers = [], []
    for row, line in _kept(path, first, block, cells.may_miss and cells.between == "\t"):
        rows.append(row)
        numbers.append(_numbers(path, row, line, cells))
    return np.array(rows, dtype=int), np.array(numbers).reshape(-1, cells.width)[:, wanted]


def as_text(path: Path, first: int, block: bytes) -> str:
    """Return a block as text; RecordingError names the line where it is not UTF-8, the block's own first is `first`."""
    try:
        return decoded(block, path, first)
    except TextFault as fault:
        raise RecordingError(str(fault)) from None


def _kept(path: Path, first: int, block: bytes, has_empty_rows: bool = False) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(as_text(path, first, block).removesuffix("\n").split("\n"), start=first):
        if (line if has_empty_rows else line.strip()) and not line.startswith(COMMENT):
            yield number, line


def _numbers(path: Path, row: int, line: str, cells: Cells) -> list[float]:
    found = cells.split(line)
    if len(found) != cells.width:
        raise RecordingError(f"{path}: row {row} has {len(found)} cells, must have {cells.width}")
    numbers = []
    for column, cell in enumerate(found, start=1):
        number = cells.number(cell or "nan" if cells.may_miss else cell)
        if number is None or not (np.isfinite(number) or (cells.may_miss and np.isnan(number))):
            raise RecordingError(f"{path}: row {row}, column {column}: {cell[:60]!r}, must be a finite number")
        numbers.append(number)
    return numbers
