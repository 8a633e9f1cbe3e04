"""docs/thesis.md from the rows and the kept values."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from benchmarks.page_table import table
from benchmarks.thesis.groups import MADE, Group
from benchmarks.thesis.rows import VERDICTS, Chapter, Row

HEAD = """\
# The thesis, figure by figure

This page lists every figure and table of chapters 2 to 8 of O. Sörnmo's thesis (Lund 2015): the printed value, the
value of this program, the commands, and why they differ.

- **The thesis' figures** are of real machines unless marked "simulation".
- **Ours** are of the simulated machines, seed 1 and default settings unless stated otherwise. So a better value of ours
  says little: it is another plant, with other noise, in a simulator of our own ([figures of the simulators](home.md),
  [of drawn machines](populations.md)). A worse value needs an explanation, which is in the last column.
- **"Alike"** is within 2 %. A dash means that there is no value of ours; the reason is in the last column.

`make thesis` computes this page again, in {minutes:.0f} minutes of processor time, and continues after a stop.
`python -m benchmarks.thesis --only 5.7` computes the rows of one figure. The column "by" names the group of commands,
which runs in a folder of its own, `runs/thesis/GROUP`. The groups are listed [at the end](#the-commands).
"""
COLUMNS = ("figure", "what", "thesis", "ours", "", "by", "why they differ")
WORSE = "## Where ours is worse\n"
NO_DRAWINGS = "none"
AS_ABOVE = "as above"
"""The reason of the row before."""


def page(chapters: Sequence[Chapter], groups: Mapping[str, Group], kept: Mapping[str, Any]) -> str:
    """Return the page that belongs to kept values.

    Parameters
    ----------
    chapters : sequence of Chapter
    groups : mapping of str to Group
    kept : mapping
        `values` by row's key; `groups`: of each `seconds` of processor time, `time` and `software`; `machine`.
    """
    parts = [HEAD.format(minutes=sum(each["seconds"] for each in kept["groups"].values()) / 60)]
    parts += [counts(chapters, kept["values"]), WORSE, _worse(chapters, kept["values"])]
    for chapter in chapters:
        parts += [f"\n## Chapter {chapter.number}: {chapter.title}\n", _chapter(chapter, kept["values"])]
    parts += ["\n## The commands\n", commands(groups, kept["groups"]), _origin(kept)]
    return "\n".join(parts)


def counts(chapters: Sequence[Chapter], values: Mapping[str, Any]) -> str:
    """Return how many rows are better, worse, alike or neither, and how many have none of ours."""
    rows = [row for chapter in chapters for row in chapter.rows]
    made = [row for row in rows if row.group]
    found = [row.verdict(values[row.key]) for row in made]
    better, worse, alike, neither = (found.count(verdict) for verdict in VERDICTS)
    return (
        f"Of {len(rows)} rows ours is better in {better}, alike in {alike} and worse in {worse}.\n"
        f"In {neither} no verdict is possible, mostly because no number is printed; {len(rows) - len(made)} have no "
        "value of ours.\n"
    )


def commands(groups: Mapping[str, Group], kept: Mapping[str, Any]) -> str:
    """Return the table of all groups."""
    rows = [
        [name, "<br>".join(f"`{_printed(each)}`" for each in group.commands), f"{kept[name]['seconds']:.0f}"]
        for name, group in groups.items()
        if name in kept
    ]
    return table(["group", "commands, in `runs/thesis/GROUP`", "processor, s"], rows)


def _printed(command: str) -> str:
    if command.split()[0] != MADE:
        return command
    case, *files = command.split()[1:]
    return f"python -m benchmarks.thesis --case {' '.join([case, *files])} > {case}.json"


def _worse(chapters: Sequence[Chapter], values: Mapping[str, Any]) -> str:
    told, reason = [], ""
    for row in (row for chapter in chapters for row in chapter.rows):
        reason = row.why if row.why != AS_ABOVE else reason
        if _verdict(row, values) == "worse":
            told.append(_cells(replace(row, why=reason), values))
    return table(COLUMNS, told) if told else "Nowhere."


def _chapter(chapter: Chapter, values: Mapping[str, Any]) -> str:
    drawn = "; ".join(f"{at} ({what})" for at, what in chapter.drawings.items()) or NO_DRAWINGS
    return f"Drawings, no value: {drawn}.\n\n" + table(COLUMNS, list(_rows(chapter, values)))


def _rows(chapter: Chapter, values: Mapping[str, Any]) -> Iterator[list[str]]:
    return (_cells(row, values) for row in chapter.rows)


def _cells(row: Row, values: Mapping[str, Any]) -> list[str]:
    ours = values.get(row.key)
    return [row.at, row.what, row.printed, row.told(ours), _verdict(row, values), row.group or "-", row.why]


def _verdict(row: Row, values: Mapping[str, Any]) -> str:
    return row.verdict(values[row.key]) if row.group else ""


def _origin(kept: Mapping[str, Any]) -> str:
    times = sorted(each["time"] for each in kept["groups"].values())
    software = sorted({each["software"] for each in kept["groups"].values()})
    made = f"\nMade from {times[0][:16]} to {times[-1][:16]} UTC on {kept['machine']}, by {'; '.join(software)}"
    return f"{made}; kept in `docs/thesis.json`.\n"
