"""Pictures of a study: distributions, survival curves, and figures over settings."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture

from rigkit.figure_style import COLOURS, LIMIT, styled
from rigkit.report import Plot
from rigkit.study.file import Figure
from rigkit.study.results import Row
from rigkit.study.summary import Group, survival
from rigkit.study.tables import title

MOST_CURVES = len(COLOURS)
"""Groups that are drawn as curves; more are drawn over their settings."""
MOST_SETTINGS = 4
_BOUND: dict[str, Any] = {**LIMIT}
_WIDE = 30.0
"""Largest over smallest of positive values that are drawn on a logarithmic axis."""


def plots(rows: Sequence[Row], groups: Sequence[Group], name: str, figure: Figure) -> tuple[Plot, ...]:
    """Return the pictures of one figure; none of text, and none where no task has it."""
    has_any = any(row.figures[name] is not None for row in rows)
    if figure.kind == "text" or not has_any:
        return ()
    with styled():
        if len(groups) > MOST_CURVES:
            return _over_settings(rows, name, figure)
        if figure.kind == "event":
            return (_survival(groups, name, figure),)
        return () if figure.kind == "yes" else (_distribution(groups, name, figure),)


def _survival(groups: Sequence[Group], name: str, figure: Figure) -> Plot:
    picture = Picture()
    axes = picture.subplots()
    for group, colour in zip(groups, COLOURS, strict=False):
        time, share, low, high = survival(group.rows, name, figure)
        axes.step(time, 100 * share, where="post", color=colour, label=f"{group.label} ({len(group.rows)})")
        axes.fill_between(time, 100 * low, 100 * high, step="post", color=colour, alpha=0.15, linewidth=0)
    axes.set(xlabel=title(name, figure), ylabel="not reached yet, % of tasks", ylim=(0, 102), xlim=(0, figure.until))
    _legend(axes, groups)
    caption = (
        "Tasks in which it had not come by then, with 95 % intervals (Wilson). Those that are left at "
        f"{figure.until:g} are censored there; refused and failed ones count as never."
    )
    return Plot(picture, caption)


def _distribution(groups: Sequence[Group], name: str, figure: Figure) -> Plot:
    picture = Picture()
    axes = picture.subplots()
    everything = []
    for group, colour in zip(groups, COLOURS, strict=False):
        values = np.sort(np.array([row.figures[name] for row in group.rows if row.figures[name] is not None], float))
        everything.append(values)
        share = 100 * np.arange(1, len(values) + 1) / max(len(group.rows), 1)
        label = f"{group.label} ({len(values)} of {len(group.rows)})"
        axes.step(values, share, where="post", color=colour, label=label, marker=".", markersize=4)
    if figure.passes:
        axes.axvline(float(figure.passes.split()[1]), label=figure.passes, **_BOUND)
    _scale(axes, np.concatenate(everything), "x")
    axes.set(xlabel=title(name, figure), ylabel="cumulative share, % of tasks", ylim=(0, 102))
    _legend(axes, groups)
    caption = "Distribution over all tasks; a curve that ends below 100 % lacks those that were refused or failed."
    return Plot(picture, caption)


def _over_settings(rows: Sequence[Row], name: str, figure: Figure) -> tuple[Plot, ...]:
    """Return the figure over each setting that has many values, events that never came at their end."""
    ended = [row for row in rows if row.status == 0 and (row.figures[name] is not None or figure.kind == "event")]
    values = np.array([_drawn(row, name, figure) for row in ended])
    keys = [key for key in rows[0].case if _is_numeric(row.case.get(key) for row in rows)][:MOST_SETTINGS]
    if not keys or not len(values):
        return ()
    picture = Picture(figsize=(8.0, 3.2))
    every = np.atleast_1d(picture.subplots(1, len(keys), sharey=True))
    machines = list(dict.fromkeys(row.machine for row in rows))
    for axes, key in zip(every, keys, strict=True):
        at = np.array([float(row.case[key]) for row in ended])
        for number, machine in enumerate(machines[:MOST_CURVES]):
            mask = np.array([row.machine == machine for row in ended])
            axes.plot(at[mask], values[mask], ".", color=COLOURS[number], label=machine)
        _scale(axes, at, "x")
        axes.set(xlabel=key)
    _scale(every[0], values, "y")
    every[0].set(ylabel=title(name, figure))
    if len(machines) > 1:
        every[-1].legend()
    never = f"; events that never came at {figure.until:g}" if figure.kind == "event" else ""
    return (Plot(picture, f"Each task that ended well, over the settings{never}."),)


def _drawn(row: Row, name: str, figure: Figure) -> float:
    value = row.figures[name]
    return figure.until if value is None else float(value)


def _is_numeric(values: object) -> bool:
    each = list(values)  # type: ignore[call-overload]  # an iterable
    return all(isinstance(value, int | float) for value in each) and len(set(each)) > 2


def _scale(axes: Axes, values: np.ndarray, axis: str) -> None:
    if len(values) and values.min() > 0 and values.max() > _WIDE * values.min():
        axes.set(**{f"{axis}scale": "log"})


def _legend(axes: Axes, groups: Sequence[Group]) -> None:
    if len(groups) > 1:
        axes.legend()
