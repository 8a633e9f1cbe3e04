"""Two results of the same study, task by task: by how much each figure differs."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from rigkit.json_text import json_text
from rigkit.study.file import Figure
from rigkit.study.results import Row


@dataclass(frozen=True)
class Difference:
    """How far one figure of two results is apart.

    Parameters
    ----------
    count : int
        Tasks that both have, and in which at least one has the figure.
    differing : int
        Those in which it is not the same to the last bit.
    largest : float
        Largest difference, of the larger value; infinite where only one has it, or where texts differ.
    worst : Row or None
        The task with that one.
    """

    count: int
    differing: int
    largest: float
    worst: Row | None


def matched(one: Iterable[Row], other: Iterable[Row]) -> list[tuple[Row, Row]]:
    """Return the tasks that both have: the same machine, seed and settings.

    Raises
    ------
    ValueError : there is none.
    """
    there = {_name(row): row for row in other}
    pairs = [(row, there[_name(row)]) for row in one if _name(row) in there]
    if not pairs:
        raise ValueError("the two have no task in common: plant, seed and settings must be the same")
    return pairs


def difference(pairs: Iterable[tuple[Row, Row]], name: str, figure: Figure) -> Difference:
    """Return by how much one figure differs."""
    known = [pair for pair in pairs if any(row.figures[name] is not None for row in pair)]
    apart = [(_apart(pair[0].figures[name], pair[1].figures[name], figure), pair[0]) for pair in known]
    largest, worst = max(apart, key=lambda each: each[0], default=(0.0, None))
    return Difference(len(known), sum(each > 0 for each, _ in apart), largest, worst)


def ends_differently(pairs: Iterable[tuple[Row, Row]]) -> list[tuple[Row, Row]]:
    """Return the tasks whose exit status is not the same."""
    return [pair for pair in pairs if pair[0].status != pair[1].status]


def is_within(found: Mapping[str, Difference], figures: Mapping[str, Figure], tolerance: float) -> bool:
    """Whether no figure but measured times differs by more than `tolerance`, of the larger value."""
    return all(each.largest <= tolerance for name, each in found.items() if not figures[name].timing)


def _apart(one: float | str | None, other: float | str | None, figure: Figure) -> float:
    if one == other:
        return 0.0
    if one is None or other is None or figure.kind == "text":
        return math.inf
    larger = max(abs(float(one)), abs(float(other)))
    return abs(float(one) - float(other)) / larger


def _name(row: Row) -> tuple[str, int, str]:
    return row.machine, row.seed, json_text(row.case)
