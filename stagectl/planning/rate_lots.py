"""How far the rates of milled pockets were off what was believed, and the file that keeps that between runs."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from rigkit import atomic
from rigkit.json_file import read_json
from rigkit.json_text import json_text
from stagectl.planning.problem import LARGEST_TOOL, SIDES, milling_types, shortened
from stagectl.planning.rate_belief import Prior

KEYS = ("scales", "lots")
_TYPES = {name for tool in range(1, LARGEST_TOOL + 1) for name in milling_types(tool, "EWNS")}


@dataclass
class Lot:
    """What was milled of one material by one table of rates: sums of log(rate / believed rate), by strip.

    Parameters
    ----------
    sums : mapping of (type, side) to [count, sum, sum of squares], 1
    """

    sums: dict[tuple[str, str], list[float]] = field(default_factory=dict)

    def add(self, name: str, side: str, excess: float) -> None:
        """Take in a segment: its type, its side, and the logarithm of its rate over the believed one, 1."""
        known = self.sums.setdefault((name, side), [0.0, 0.0, 0.0])
        known[0] += 1.0
        known[1] += excess
        known[2] += excess * excess


def write_lots(path: Path, lots: Sequence[Lot], prior: Prior) -> None:
    """Write lots, and for people the scales that were estimated from them."""
    rows = [[[name, side, *sums] for (name, side), sums in lot.sums.items()] for lot in lots]
    atomic.write(path, json_text({"scales": asdict(prior), "lots": rows}) + "\n")


def read_lots(path: Path) -> list[Lot]:
    """Read what `write_lots` has written; the scales are not looked at.

    Raises
    ------
    ValueError : it is something else; the text begins with the file.
    OSError : it cannot be read.
    """
    given = read_json(path, dict)
    if set(given) != set(KEYS) or not isinstance(given["lots"], list):
        raise ValueError(f"{path}: has {', '.join(given) or 'nothing'}, must have {', '.join(KEYS)}, the last a list")
    return [_lot(path, rows) for rows in given["lots"]]


def _lot(path: Path, rows: Any) -> Lot:
    lot = Lot()
    for row in rows if isinstance(rows, list) else [rows]:
        if not _is_strip(row):
            raise ValueError(
                f"{path}: has {shortened(row)}, must be [type, side, count >= 1, sum, sum of squares >= 0]"
            )
        lot.sums[row[0], row[1]] = [float(each) for each in row[2:]]
    return lot


def _is_strip(row: Any) -> bool:
    if not (isinstance(row, list) and len(row) == 5 and all(isinstance(each, str) for each in row[:2])):
        return False
    name, side, *sums = row
    if not all(isinstance(each, int | float) and math.isfinite(each) for each in sums):
        return False
    count, total, squares = sums
    has_strip = name in _TYPES and side in SIDES[name[0]] and side != ""
    return has_strip and count >= 1 and squares >= 0.0 and total * total <= count * squares * (1.0 + 1e-9) + 1e-12
