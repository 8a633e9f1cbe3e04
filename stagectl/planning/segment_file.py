"""Files of finished segments: CSV, a row each, from which a planner goes on learning."""

import csv
import io
import math
from collections.abc import Iterable
from pathlib import Path

from rigkit import atomic
from rigkit.text_file import read_text
from stagectl.planning.milling import Milled
from stagectl.planning.problem import Pocket, PocketFault
from stagectl.planning.strip_kernel import length
from stagectl.planning.strips import NO_WAY, Cut, Rectangle, Standing

HEAD = ("pocket", "type", "side", "row", "col", "cells", "lifted", "moved", "duration", "force_deviation")
"""Cells fed, 0 or 1, s, s, N; the last one is empty where no force was measured."""
NEEDED = ("type", "side", "cells", "duration")


def write_segments(path: Path, pockets: Iterable[Iterable[Milled]]) -> None:
    """Write the segments of pockets that were milled one after the other."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(HEAD)
    for number, segments in enumerate(pockets, start=1):
        for each in segments:
            cells = length(each.cut.way, tuple(each.standing.uncut))
            force = each.force_deviation
            table.writerow([
                number, each.name, each.cut.side, each.row, each.col, cells, int(each.is_lifted), repr(each.moved),
                repr(each.duration), repr(force) if math.isfinite(force) else "",
            ])  # fmt: skip
    atomic.write(path, text.getvalue())


def read_segments(path: Path, pocket: Pocket) -> list[Milled]:
    """Read segments to learn from: type, side, cells fed and duration; of any pocket with the same tool.

    Raises
    ------
    PocketFault : a column or a value is missing or out of its range; the text begins with file and line.
    TextFault : the file is not UTF-8.
    OSError : it cannot be read.
    """
    rows = csv.DictReader(read_text(path).splitlines(keepends=True))
    try:
        missing = [name for name in NEEDED if name not in (rows.fieldnames or ())]
        if missing:
            raise PocketFault(f"{path}: there is no column {', '.join(missing)}, must have {', '.join(NEEDED)}")
        return [_segment(f"{path}: line {number}", row, pocket) for number, row in enumerate(rows, start=2)]
    except csv.Error as fault:
        raise PocketFault(f"{path}: line {rows.line_num}: {fault}") from None


def _segment(place: str, row: dict[str, str | None], pocket: Pocket) -> Milled:
    name, side = row["type"] or "", row["side"] or ""
    if name not in pocket.types:
        raise PocketFault(f"{place}: type is {name!r}, must be of {', '.join(pocket.types)}")
    cuts = [Cut(way, int(name[1])) for way in range(8)]
    cut = next((each for each in cuts if each.name(pocket.G) == name and each.side == side), None)
    if cut is None:
        raise PocketFault(f"{place}: side is {side!r}, must be one off which {name} is milled")
    cells, duration = _number(place, row, "cells"), _number(place, row, "duration")
    if not duration > pocket.t_acc:
        raise PocketFault(f"{place}: duration is {duration} s, must be > t_acc, {pocket.t_acc} s")
    if not cells == int(cells):
        raise PocketFault(f"{place}: cells is {cells}, must be a whole number")
    force = _number(place, row, "force_deviation") if row.get("force_deviation") else math.nan
    reach = Rectangle(0, int(cells), 0, int(cells))
    return Milled(Standing(reach, NO_WAY), cut, name, 0, 0, False, 0.0, duration, force)


def _number(place: str, row: dict[str, str | None], name: str) -> float:
    try:
        value = float(row[name] or "")
    except ValueError:
        value = math.nan
    if not (value > 0.0 and math.isfinite(value)):
        raise PocketFault(f"{place}: {name} is {row[name]!r}, must be a number > 0")
    return value
