"""The report of a study: its figures as a page, as tables on a terminal, and for other programs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from rigkit.report import Fact, Report, Section, Table
from rigkit.study.engine import HOUR
from rigkit.study.file import Figure
from rigkit.study.outcome import REFUSED
from rigkit.study.plots import plots
from rigkit.study.results import FOLDER as RESULTS
from rigkit.study.results import About, Row, read_rows, study_hash
from rigkit.study.summary import Group, groups, statistics, worst
from rigkit.study.tables import WORST, case_name, endings_table, figure_table, title, worst_table

PAGE = "report.html"
MOST_ENDS = 10
"""Ways to fail that a terminal shows; the page has more."""


@dataclass(frozen=True)
class StudyReport:
    """What has come of a study.

    Parameters
    ----------
    about : About
    rows : tuple of Row
    """

    about: About
    rows: tuple[Row, ...]

    @classmethod
    def of(cls, path: Path) -> Self:
        """Return the report of a study's folder, or of a file of results.

        Raises
        ------
        ValueError, OSError : there are no results.
        """
        about, rows = read_rows(path / RESULTS if (path / RESULTS).is_dir() else path)
        return cls(about, tuple(rows))

    @cached_property
    def groups(self) -> list[Group]:
        """The rows by machine and settings."""
        return groups(self.rows, self.about.group)

    @property
    def hash(self) -> str:
        """The study's hash."""
        return study_hash(self.rows, self.about.figures)

    @property
    def spent(self) -> float:
        """Processor time, h."""
        return sum(row.cpu for row in self.rows) / HOUR

    @property
    def finished(self) -> str:
        """When the last task ended: UTC, ISO 8601."""
        return max(row.finished for row in self.rows)

    def tables(self) -> list[tuple[str, Table]]:
        """Return a table for each figure with its title."""
        return [(title(name, figure), figure_table(self.groups, name, figure)) for name, figure in self._figures]

    def worst_tables(self) -> list[tuple[str, Table]]:
        """Return the worst cases of each figure that is a number."""
        numbers = [(name, figure) for name, figure in self._figures if figure.kind in ("number", "event")]
        return [(title(name, figure), worst_table(self.rows, name, figure)) for name, figure in numbers]

    def lines(self) -> Iterator[str]:
        """Return the worst case of each figure and how tasks failed, with command lines to be copied."""
        for text, table in self.worst_tables():
            for name, value, line in table.rows[:1]:
                yield f"worst case of {text}: {value}, {name}\n  {line}\n"
        for message, status, count, name, line in endings_table(self.rows).rows[:MOST_ENDS]:
            yield f"status {status}, {count} tasks: {message}; the first is {name}\n  {line}\n"

    def told(self) -> dict[str, Any]:
        """Return all figures as JSON takes them."""
        return {
            "study": self.about.name,
            "hash": self.hash,
            "tasks": len(self.rows),
            "refused": self._count(REFUSED),
            "failed": sum(row.status not in (0, REFUSED) for row in self.rows),
            "cpu_hours": self.spent,
            "finished": self.finished,
            "software": self._several("software"),
            "processors": self._several("processor"),
            "figures": {name: self._told(name) for name in self.about.figures},
        }

    def page(self) -> Report:
        """Return the page."""
        sections = [
            Section(text, plots=plots(self.rows, self.groups, name, figure), tables=(table,))
            for (name, figure), (text, table) in zip(self._figures, self.tables(), strict=True)
        ]
        why = (
            "Each line repeats its task in an empty folder in which the study's files lie, with OPENBLAS_NUM_THREADS=1."
        )
        worst_tables = tuple(table for _, table in self.worst_tables() if table.rows)
        if worst_tables:
            sections.append(Section("Worst cases", why, tables=worst_tables))
        if ends := endings_table(self.rows).rows:
            sections.append(Section("Refused and failed", why, tables=(endings_table(self.rows),)))
        kinds = "; ".join([*self._several("software"), *self._several("processor")])
        where = f"{self.about.purpose} {self.finished}; {kinds}; hash {self.hash}".strip()
        return Report(f"Study {self.about.name}", where, self._facts(bool(ends)), tuple(sections))

    @property
    def _figures(self) -> list[tuple[str, Figure]]:
        """All but the one whose words are the groups."""
        return [(name, figure) for name, figure in self.about.figures.items() if name != self.about.group]

    def _facts(self, has_ends: bool) -> tuple[Fact, ...]:
        seeds = [row.seed for row in self.rows]
        facts = [
            Fact("tasks", f"{len(self.rows)}"),
            Fact("seeds", f"{len(set(seeds))}: {min(seeds)} to {max(seeds)}"),
            Fact("processor time", f"{self.spent:.3g} h"),
        ]
        if has_ends:
            refused, failed = self._count(REFUSED), sum(row.status not in (0, REFUSED) for row in self.rows)
            facts += [Fact("refused", f"{refused}"), Fact("failed", f"{failed}", passed=failed == 0)]
        return tuple(facts)

    def _count(self, status: int) -> int:
        return sum(row.status == status for row in self.rows)

    def _several(self, name: str) -> list[str]:
        return sorted({getattr(row, name) for row in self.rows})

    def _told(self, name: str) -> dict[str, Any]:
        figure = self.about.figures[name]
        each = [
            {"machine": group.machine, "settings": group.case, **statistics(group.rows, name, figure).told}
            for group in self.groups
        ]
        cases = worst(self.rows, name, figure, WORST) if figure.kind in ("number", "event") else []
        return {
            "title": figure.title or name,
            "unit": figure.unit,
            "kind": figure.kind,
            "groups": each,
            "worst": [_case(row, name) for row in cases],
        }


def _case(row: Row, name: str) -> dict[str, Any]:
    told: Sequence[str] = row.commands
    return {"case": case_name(row), "seed": row.seed, "value": row.figures[name], "commands": list(told)}
