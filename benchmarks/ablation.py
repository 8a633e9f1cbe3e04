"""What each part of a law is worth: the same machines with all of it and without each, from the results of a study."""

import math
from collections.abc import Sequence

import numpy as np

from rigkit.report import Table
from rigkit.study.report import StudyReport
from rigkit.study.results import Row
from rigkit.study.tables import markdown

ALL = "all"
NOTABLE = 0.5
"""dB that are a difference."""
HEAD = (
    *("", "N", "objective met and held", "sooner, later than with all of it"),
    *(f"last shot better, worse by {NOTABLE:g} dB", "worse by, dB: mean", "least, median, most"),
)


def ablation_table(found: StudyReport) -> str:
    """Return a row for each part: what becomes of the objective and of the last shot's worst line without it.

    N counts the machines that ran to the end both ways.
    """
    parts = [name for name in found.about.figures if f"{name}_last" in found.about.figures]
    titles = {name: found.about.figures[name].title.partition(":")[0] for name in parts}
    return markdown(Table(HEAD, tuple((titles[name], *_cells(found.rows, name)) for name in parts)))


def _cells(rows: Sequence[Row], part: str) -> tuple[str, ...]:
    both = [row for row in rows if all(_is_told(row.figures.get(f"{name}_last")) for name in (ALL, part))]
    shots = [tuple(shot(row.figures[name]) for name in (part, ALL)) for row in both]
    worse = np.array([float(row.figures[f"{part}_last"]) - float(row.figures[f"{ALL}_last"]) for row in both])
    met = f"{sum(math.isfinite(without) for without, _ in shots)}"
    if part == ALL or not both:
        return f"{len(both)}", met, *[""] * 4
    return (
        f"{len(both)}",
        met,
        f"{sum(without < usual for without, usual in shots)}, {sum(without > usual for without, usual in shots)}",
        f"{np.sum(worse < -NOTABLE)}, {np.sum(worse > NOTABLE)}",
        f"{worse.mean():+.2f}",
        ", ".join(f"{each:+.2f}" for each in (worse.min(), float(np.median(worse)), worse.max())),
    )


def _is_told(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def shot(value: float | str | None) -> float:
    """Return a shot; none came: infinite."""
    return math.inf if value is None else float(value)
