"""The tables of a study, for the terminal, a page and the documentation."""

import math
import re
from collections.abc import Iterable, Sequence

from rigkit.report import Table
from rigkit.study.file import Figure
from rigkit.study.results import Row
from rigkit.study.summary import Group, statistics, worst

MOST_GROUPS = 40
"""Rows of a figure's table; the JSON has all."""
WORST = 5
_NUMBER = re.compile(r"-?\d[\d.]*(e[-+]?\d+)?")


def figure_table(groups: Sequence[Group], name: str, figure: Figure) -> Table:
    """Return a row a group: how many, what came of them, quantiles and share."""
    each = [(group, statistics(group.rows, name, figure)) for group in groups[:MOST_GROUPS]]
    if figure.kind == "text":
        words = sorted({word for _, found in each for word in found.words})
        rows = [
            (group.label, f"{found.count}", *(f"{found.words.get(word, 0)}" for word in words)) for group, found in each
        ]
        return Table(("", "N", *words), tuple(rows))
    head, cells = ["", "N", "refused", "failed"], []
    if figure.kind != "yes":
        head += ["5 %", "median", "95 %", "lowest", "highest"]
    has_share = any(found.share is not None for _, found in each)
    if has_share:
        head += [_share_title(figure), "95 % interval"]
    for group, found in each:
        cell = [group.label, f"{found.count}", f"{found.refused}", f"{found.failed}"]
        if figure.kind != "yes":
            cell += [number(value, figure) for value in (*found.quantiles, found.lowest, found.highest)]
        if found.share is not None:
            cell += [found.share.text, found.share.interval]
        cells.append(tuple(cell))
    return Table(tuple(head), tuple(cells))


def worst_table(rows: Sequence[Row], name: str, figure: Figure) -> Table:
    """Return the worst cases by name, each with the command line that repeats it in an empty folder."""
    found = worst(rows, name, figure, WORST)
    cells = [(case_name(row), number(_value(row, name), figure), command(row)) for row in found]
    return Table(("", title(name, figure), "in an empty folder, with the study's files"), tuple(cells))


def endings_table(rows: Sequence[Row]) -> Table:
    """Return how tasks ended that did not end well: how often, the first of them by name, and its command line.

    Last lines that differ in their numbers alone are one.
    """
    ends: dict[tuple[int, str], list[Row]] = {}
    for row in rows:
        if row.status:
            ends.setdefault((row.status, _NUMBER.sub("#", row.message)), []).append(row)
    often = sorted(ends.values(), key=len, reverse=True)[:MOST_GROUPS]
    cells = [
        (alike[0].message or "-", f"{alike[0].status}", f"{len(alike)}", case_name(alike[0]), command(alike[0]))
        for alike in often
    ]
    return Table(
        ("last line", "status", "tasks", "the first", "in an empty folder, with the study's files"), tuple(cells)
    )


def case_name(row: Row) -> str:
    """Return the name of a task: machine, seed and settings."""
    case = "".join(f", {key}={value}" for key, value in row.case.items())
    return f"{row.machine}-{row.seed}{case}"


def command(row: Row) -> str:
    """Return a line for a shell that repeats a task, as far as it went."""
    return " && ".join(row.commands[: row.failed or None])


def title(name: str, figure: Figure) -> str:
    """Return what a figure is called, with its unit."""
    return f"{figure.title or name}, {figure.unit}" if figure.unit and figure.unit != "1" else figure.title or name


def number(value: float | None, figure: Figure) -> str:
    """Return a value as text; of an event, that it never came."""
    if value is None or math.isnan(value):
        return "never" if figure.kind == "event" and value is None else "-"
    return "never" if math.isinf(value) else f"{value:.4g}"


def markdown(table: Table) -> str:
    """Return a table as Markdown."""
    lines: Iterable[Sequence[str]] = (table.head, ["---"] + ["---:"] * (len(table.head) - 1), *table.rows)
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |" for cells in lines)


def _share_title(figure: Figure) -> str:
    if figure.passes:
        return figure.passes
    return "yes" if figure.kind == "yes" else f"by {figure.until:g}"


def _value(row: Row, name: str) -> float | None:
    value = row.figures[name]
    return None if value is None else float(value)
