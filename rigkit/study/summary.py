"""Statistics of a study: each figure of each group, a machine with one case of the settings."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest

from rigkit.json_text import json_text
from rigkit.study.file import Figure
from rigkit.study.outcome import REFUSED
from rigkit.study.results import Row
from rigkit.toml_text import value_text

QUANTILES = (0.05, 0.5, 0.95)
ALL = "all"
"""The machine of a group that has rows of all of them."""


@dataclass(frozen=True)
class Group:
    """The rows of one machine with one case of the settings.

    Parameters
    ----------
    label : str
        What tells it from the others.
    machine : str
    case : mapping
    rows : tuple of Row
    """

    label: str
    machine: str
    case: Mapping[str, Any]
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Share:
    """How many of all, and within which bounds their share lies with 95 % confidence.

    Parameters
    ----------
    count, of : int
    low, high : float, of 1
        Wilson's interval; NaN where there are none.
    """

    count: int
    of: int
    low: float
    high: float

    @property
    def text(self) -> str:
        """It in words."""
        return f"{self.count}/{self.of}" if self.of else "-"

    @property
    def interval(self) -> str:
        """The bounds in per cent."""
        return f"{100 * self.low:.0f}-{100 * self.high:.0f} %" if self.of else "-"


@dataclass(frozen=True)
class Statistics:
    """One figure of one group.

    Parameters
    ----------
    count, refused, failed : int
        Tasks in all; refused; with any other exit status but 0.
    known : int
        Those that have the figure.
    quantiles : tuple of float
        As `QUANTILES`, of those that have it, in its unit; an event that never came is infinite.
    mean, lowest, highest : float
        Of those that have it.
    share : Share or None
        Of all tasks, those within the figure's limit, those that say yes, or those where the event came.
    words : mapping of str to int
        Of a text: how often each.
    """

    count: int
    refused: int
    failed: int
    known: int
    quantiles: tuple[float, ...]
    mean: float
    lowest: float
    highest: float
    share: Share | None
    words: Mapping[str, int]

    @property
    def told(self) -> dict[str, Any]:
        """It as JSON takes it."""
        told = asdict(self)
        told["quantiles"] = dict(zip(map(str, QUANTILES), self.quantiles, strict=False))
        return told


def groups(rows: Sequence[Row], by: str = "") -> list[Group]:
    """Return the rows by machine and case, in the order in which they come, and by the words of the figure `by`.

    Where each machine has one row of each case, the machines are what is drawn, and the rows are not apart by them.
    With `by`, the groups of all words together come last.
    """
    return [*(_groups(rows, by) if by else []), *_groups(rows, "")]


def statistics(rows: Sequence[Row], name: str, figure: Figure) -> Statistics:
    """Return the statistics of one figure; what has none, since it was refused or failed, does not pass."""
    refused = sum(row.status == REFUSED for row in rows)
    failed = sum(row.status not in (0, REFUSED) for row in rows)
    values = [row.figures[name] for row in rows if row.figures[name] is not None]
    if figure.kind == "text":
        words = dict(Counter(map(str, values)).most_common())
        return Statistics(len(rows), refused, failed, len(values), (), math.nan, math.nan, math.nan, None, words)
    numbers = np.array(values, dtype=float)
    if figure.kind == "event":
        come = numbers[numbers <= figure.until]
        everyone = np.concatenate([come, np.full(len(rows) - len(come), np.inf)])
        quantiles = _quantiles(everyone)
    else:
        come, quantiles = numbers, _quantiles(numbers)
    mean, lowest, highest = (float(of(come)) if len(come) else math.nan for of in (np.mean, np.min, np.max))
    share = share_of(sum(passes(row, name, figure) for row in rows), len(rows)) if _has_share(figure) else None
    return Statistics(len(rows), refused, failed, len(values), quantiles, mean, lowest, highest, share, {})


def passes(row: Row, name: str, figure: Figure) -> bool:
    """Whether a task's figure is within its limit, says yes, or is of an event that came."""
    value = row.figures[name]
    if value is None or isinstance(value, str):
        return False
    if figure.passes:
        sign, limit = figure.passes.split()
        bound = float(limit)
        return {"<=": value <= bound, ">=": value >= bound, "<": value < bound, ">": value > bound}[sign]
    return value <= figure.until if figure.kind == "event" else value > 0


def share_of(count: int, of: int) -> Share:
    """Return a share with Wilson's 95 % interval."""
    if not of:
        return Share(0, 0, math.nan, math.nan)
    bounds = binomtest(count, of).proportion_ci(0.95, method="wilson")
    return Share(count, of, float(bounds.low), float(bounds.high))


def worst(rows: Iterable[Row], name: str, figure: Figure, count: int) -> list[Row]:
    """Return the rows with the worst values of a figure, an event that never came before all others."""
    sign = 1 if figure.worst == "highest" else -1

    def badness(row: Row) -> float:
        value = row.figures[name]
        never = figure.kind == "event" and (value is None or float(value) > figure.until)
        return math.inf if never else sign * float(value or 0.0)

    ended = (row for row in rows if row.status == 0 and (row.figures[name] is not None or figure.kind == "event"))
    return sorted(ended, key=badness, reverse=True)[:count]


def survival(rows: Sequence[Row], name: str, figure: Figure) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the share of tasks whose event has not come, from 0 on, with its bounds.

    What was refused or failed counts as one whose event never came.  All are watched until the same time, so the
    Kaplan-Meier estimate is the plain share, and Wilson's interval its bounds.

    Returns
    -------
    time : array, shape (steps,), in the figure's unit
    share, low, high : array, shape (steps,), of 1
    """
    values = [row.figures[name] for row in rows]
    come = sorted(float(value) for value in values if value is not None and float(value) <= figure.until)
    times = np.array(sorted({0.0, *come, figure.until}))
    left = [len(rows) - sum(value <= time for value in come) for time in times]
    shares = [share_of(count, len(rows)) for count in left]
    low, high = (np.array([getattr(share, end) for share in shares]) for end in ("low", "high"))
    return times, np.array(left) / len(rows), low, high


def _has_share(figure: Figure) -> bool:
    return bool(figure.passes) or figure.kind in ("yes", "event")


def _quantiles(values: np.ndarray) -> tuple[float, ...]:
    """Return values that are there, not between two: a count stays a count, and infinity does not spread."""
    if not len(values):
        return (math.nan,) * len(QUANTILES)
    found = np.quantile(values, QUANTILES, method="inverted_cdf")
    return tuple(map(float, found))


def _groups(rows: Sequence[Row], by: str) -> list[Group]:
    machines = {row.machine for row in rows}
    is_apart = 1 < len(machines) < len({(row.machine, row.seed) for row in rows})
    found: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        word = str(row.figures[by] or "-") if by else ""
        found.setdefault((word, row.machine if is_apart else ALL, json_text(row.case)), []).append(row)
    varied = _varied([members[0].case for members in found.values()])
    made = []
    for (word, machine, _), members in sorted(found.items(), key=lambda item: item[0][0]):
        case = members[0].case
        parts = [word] * bool(by) + [machine] * is_apart
        parts += [f"{key}={_value(case[key])}" for key in varied if key in case]
        made.append(Group(", ".join(parts) or ALL, machine, case, tuple(members)))
    return made


def _varied(cases: Sequence[Mapping[str, Any]]) -> list[str]:
    keys = dict.fromkeys(key for case in cases for key in case)
    return [key for key in keys if len({json_text(case.get(key)) for case in cases}) > 1]


def _value(value: Any) -> str:
    return value if isinstance(value, str) else value_text(value)
