"""Rows of the thesis' table, from the chapters' files: what is printed, what is ours, and why they differ."""

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.thesis.groups import CHAPTERS
from rigkit.study.json_path import reduced, value_at

NEAR = 0.02
"""Relative difference up to which a value counts as the printed one."""
VERDICTS = ("better", "worse", "alike", "")


@dataclass(frozen=True)
class Row:
    """One value, curve or statement of a figure or table.

    Parameters
    ----------
    at : str
        Such as `Tab. 2.1` or `Fig. 2.13`; `Sec. 6.7` for what the text alone says.
    what : str
    printed : str
        As it is printed, with its unit; a curve without a number is said to be one.
    why : str
        Why ours differs, or what else is to be known of it.
    group, file, path : str
        Where ours is: which group's JSON file, and where in it.  Without a group there is none of ours.
    reduce : str
        One of many: min, max, mean, first, last or count.
    scale : float, 1
        What ours is multiplied by.
    form : str
        The format of ours.
    unit : str
    value : float, optional
        What is printed, as a number in `unit`.
    better : str
        Which is better: `less` or `more`; empty: neither is.
    near : float, 1
        Relative difference up to which ours counts as the printed one.
    """

    at: str
    what: str
    printed: str
    why: str = ""
    group: str = ""
    file: str = ""
    path: str = ""
    reduce: str = ""
    scale: float = 1.0
    form: str = ".3g"
    unit: str = ""
    value: float | None = None
    better: str = ""
    near: float = NEAR

    @property
    def key(self) -> str:
        """What its value is kept under."""
        return f"{self.at}: {self.what}"

    def ours(self, folder: Path) -> Any:
        """Return the value out of the group's JSON, or None where the program says none.

        Raises
        ------
        LookupError : nothing is at that path.
        """
        found = json.loads((folder / self.group / self.file).read_text(encoding="utf-8"))
        value = reduced(value_at(found, self.path), self.reduce)
        return value if value is None or isinstance(value, str | bool) else self.scale * value

    def verdict(self, ours: Any) -> str:
        """Say whether ours is better, worse or alike; empty where that cannot be said."""
        if not self.better or self.value is None:
            return ""
        if ours is None:
            return "worse"
        if abs(ours - self.value) <= self.near * abs(self.value):
            return "alike"
        return "better" if (ours < self.value) == (self.better == "less") else "worse"

    def told(self, ours: Any) -> str:
        """Return ours as text."""
        if not self.group:
            return "-"
        if ours is None:
            return "never"
        if isinstance(ours, str | bool):
            return str(ours)
        number = int(ours) if self.form == "d" else ours
        return f"{number:{self.form}} {self.unit}".strip()


@dataclass(frozen=True)
class Chapter:
    """A chapter: its number and title, drawings without a value, and rows in the order of the text."""

    number: int
    title: str
    drawings: Mapping[str, str]
    rows: tuple[Row, ...]


def chapters() -> list[Chapter]:
    """Read all chapters."""
    return [_chapter(file) for file in CHAPTERS]


def chosen(wanted: Sequence[str], known: Sequence[Chapter]) -> list[Row]:
    """Return the rows that words such as `5.7`, `Tab. 5.1` or `5` mean; all of them for no word.

    Raises
    ------
    ValueError : no row is meant by a word.
    """
    rows = [row for chapter in known for row in chapter.rows]
    for word in wanted:
        if not any(_means(word, row) for row in rows):
            raise ValueError(f"{word!r} is no figure, table or chapter with a row, must be such as 5.7 or 5")
    return [row for row in rows if not wanted or any(_means(word, row) for word in wanted)]


def places(chapter: Chapter) -> Iterator[str]:
    """Yield every figure and table of a chapter that is spoken of, `Fig. 2.1 to 2.3` one by one."""
    for at in (*chapter.drawings, *(row.at for row in chapter.rows)):
        kind, _, numbers = at.partition(" ")
        first, _, last = (text.strip() for text in numbers.partition(" to "))
        ends = [int(text.split(".")[1]) for text in (first, last or first)]
        yield from (f"{kind} {chapter.number}.{n}" for n in range(ends[0], ends[1] + 1))


def _means(word: str, row: Row) -> bool:
    number = row.at.split(" ", 1)[1]
    return word in (row.at, number, number.split(".")[0])


def _chapter(file: Path) -> Chapter:
    told = tomllib.loads(file.read_text(encoding="utf-8"))
    number = int(file.stem.split("_")[1])
    return Chapter(number, told["title"], told["drawings"], tuple(Row(**row) for row in told["rows"]))
