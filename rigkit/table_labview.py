"""Heads of LabVIEW's measurement files (.lvm): one segment, with or without a column of time."""

import itertools
from decimal import Decimal, InvalidOperation
from pathlib import Path

from ctlblocks.recording import RecordingError
from rigkit.table_head import Head
from rigkit.table_rows import Cells, cells_of, text_blocks

START = b"LabVIEW Measurement"
END = "***End_of_Header***"
LONGEST = 200
"""Lines above the rows, at most."""
UNITS = {"Volts": "V", "Amps": "A", "Newtons": "N", "Seconds": "s", "Meters": "m", "Pascals": "Pa", "Hertz": "Hz"}
"""Words of LabVIEW for units, and what other files call them."""


def labview_head(path: Path) -> Head:
    """Read the head of a measurement file.

    Parameters
    ----------
    path : Path

    Raises
    ------
    RecordingError : a head without its end, times of its own for each channel, or periods that differ.

    Source
    ------
    National Instruments, Specification for the LabVIEW Measurement File (.lvm), version 2.0.  Its tag "Samples" is not
    gone by: programs that append to a file leave it as it was.
    """
    number, head = _head(path)
    mark = "," if any(line.startswith("Separator,") for line in head) else "\t"
    said: dict[str, list[str]] = {}
    for line in head[:-1]:
        key, *values = (cell.strip() for cell in line.split(mark))
        said.setdefault(key, [value for value in values if value])
    columns = [cell for cell in cells_of(head[-1], mark) if cell != "Comment"]
    shape = _first(said, "X_Columns", "One")
    if shape not in ("One", "No") or columns[:1] != ["X_Value"] or len(columns) < 2:
        raise RecordingError(
            f"{path}: X_Columns is {shape}, columns are {', '.join(columns)}, must be one X_Value or none"
        )
    decimal = _first(said, "Decimal_Separator", ".")
    if decimal not in (".", ",") or decimal == mark:
        raise RecordingError(
            f"{path}: Decimal_Separator is {decimal!r}, must be a point, or a comma with Separator Tab"
        )
    rate, slack = _rate(path, said, decimal)
    labels = said.get("Y_Unit_Label", [])
    units = (
        [UNITS.get(label, label) for label in labels] if len(labels) == len(columns) - 1 else ["1"] * (len(columns) - 1)
    )
    if shape == "One":
        units = ["s", *units]
    else:
        columns = columns[1:]
    cells = Cells(mark, len(columns), decimal, open_ended=True)
    return Head(tuple(columns), tuple(units), number + 1, cells, rate, slack)


def _head(path: Path) -> tuple[int, list[str]]:
    """Return the lines above the rows, the last of them the names of columns, and how many they are."""
    lines, ends = [], 0
    for _, block in itertools.islice(text_blocks(path), 1):
        for line in block.decode("latin-1").split("\n")[:LONGEST]:
            lines.append(_text(line))
            if ends == 2:
                return len(lines), lines
            ends += line.startswith(END)
    raise RecordingError(f"{path}: {END} comes {ends} times in {len(lines)} rows, must come twice, above the names")


def _text(line: str) -> str:
    """Return a line that was read as Latin-1, which LabVIEW writes on some computers, as UTF-8 where it is that."""
    try:
        return line.encode("latin-1").decode()
    except UnicodeDecodeError:
        return line


def _rate(path: Path, said: dict[str, list[str]], decimal: str) -> tuple[float | None, float]:
    """Return the rate and by how much the period is rounded, s."""
    periods = set(said.get("Delta_X", []))
    if not periods:
        return None, 0.0
    try:
        (period,) = {Decimal(text.replace(decimal, ".")) for text in periods}
        exponent = period.as_tuple().exponent
    except (ValueError, InvalidOperation):
        raise RecordingError(f"{path}: Delta_X is {', '.join(sorted(periods))}, must be one period in s") from None
    if not (isinstance(exponent, int) and 0 < period < 10**9 and exponent > -300):
        raise RecordingError(f"{path}: Delta_X is {period}, must be > 0 s")
    return float(1 / period), 0.5 * 10.0**exponent


def _first(said: dict[str, list[str]], key: str, default: str) -> str:
    return next(iter(said.get(key, [])), default)
