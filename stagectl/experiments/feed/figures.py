"""The figures of force-controlled milling: forces, kappa and beta with their deviations, feed, as in fig. 7.5."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ctlblocks.recording import Recording
from rigkit.figure_style import COLOURS, LIMIT
from rigkit.report import Plot
from stagectl.experiments.feed.noticed import noticed
from stagectl.experiments.feed.process_run import channel
from stagectl.robot.milling.feed_record import CONTROLLING

BLUE, RED, GREEN, PURPLE, SKY, ORANGE, BLACK = COLOURS
BOUND: dict[str, Any] = {**LIMIT}
"""Keywords of a line that shows a limit."""
MARKS = 6
"""Notices that are drawn; all are in the report's table."""
POINTS = 5_000
"""Drawn of a line."""


@dataclass(frozen=True)
class Names:
    """What the channels are called, of which each recording has its own."""

    along: str
    across: str
    feed: str


CELL = Names("along_1", "along_2", "feed")
PROCESS = Names("force_1", "force_2", "reference")


def control_plot(record: Recording, force: float, names: Names) -> Plot:
    """Draw forces, kappa, beta and feed over time; what is true dashed, where it is known.

    Parameters
    ----------
    record : Recording
    force : float, N
        Wanted.
    names : Names
    """
    figure = Figure(figsize=(8.0, 8.2))
    has_estimates = "kappa" in record.names
    panels = figure.subplots(4 if has_estimates else 2, 1, sharex=True)
    time, step = np.arange(len(record.data)) / record.rate, max(1, len(record.data) // POINTS)
    _forces(panels[0], record, time, step, force, names)
    if has_estimates:
        _estimate(panels[1], record, "kappa", 1e3, "κ, mm/(N s)", time, step)
        _estimate(panels[2], record, "beta", 1.0, "β", time, step)
    panels[-1].plot(time[::step], 1e3 * channel(record, names.feed)[::step], color=BLUE, label="reference of the robot")
    if has_estimates:
        panels[-1].plot(
            time[::step], 1e3 * channel(record, "estimated")[::step], color=RED, linewidth=0.8, label="observed"
        )
        panels[-1].legend(loc="best", ncols=2)
        panels[-1].set_ylim(bottom=min(-1.0, 1.05e3 * channel(record, names.feed).min()))
        panels[-1].set_ylim(top=1.2e3 * max(channel(record, names.feed).max(), 1e-3))
    _mark(panels, record)
    panels[-1].set_ylabel("feed, mm/s")
    panels[-1].set_xlabel("time, s")
    return Plot(
        figure,
        "From above: the force's parts and its size; κ and β with twice their standard deviation, while the force is "
        "controlled, true ones dashed; the feed.  Upright lines are where something was noticed.",
    )


def _mark(panels: Sequence[Axes], record: Recording) -> None:
    """Draw an upright line where force control has noticed something; what it was is said once, above."""
    for number, each in enumerate(found := noticed(record)[:MARKS]):
        for panel in panels:
            panel.axvline(each.time, color=ORANGE, linewidth=0.8)
        upright = panels[0].get_xaxis_transform()
        panels[0].text(each.time, 1.0, f"{number + 1}", transform=upright, ha="center", va="bottom", fontsize="small")
    if found:
        told = [f"{number + 1}: {each.what}" for number, each in enumerate(found)]
        panels[0].set_title("\n".join(told), fontsize="x-small", loc="left", pad=14.0)


def _forces(panel: Axes, record: Recording, time: np.ndarray, step: int, force: float, names: Names) -> None:
    for name, colour, label in (
        (names.along, GREEN, "against the feed"),
        (names.across, PURPLE, "across"),
        ("resultant", BLUE, "resultant"),
    ):
        shown = channel(record, name)
        if "valid" in record.names:
            shown = np.where(channel(record, "valid") > 0.5, shown, np.nan)
        panel.plot(time[::step], shown[::step], color=colour, linewidth=0.7, label=label)
    panel.axhline(force, **BOUND)
    panel.set_ylabel("force, N")
    panel.legend(loc="best", ncols=3)


def _estimate(panel: Axes, record: Recording, name: str, scale: float, label: str, time: np.ndarray, step: int) -> None:
    on = channel(record, "phase") == CONTROLLING
    value, deviation = (np.where(on, scale * channel(record, each), np.nan) for each in (name, f"{name}_deviation"))
    panel.plot(time[::step], value[::step], color=BLUE, linewidth=1.0, label="estimated")
    low, high = (value - 2 * deviation)[::step], (value + 2 * deviation)[::step]
    panel.fill_between(time[::step], low, high, color=SKY, alpha=0.4, linewidth=0)
    if f"true_{name}" in record.names:
        true = np.where(on, scale * channel(record, f"true_{name}"), np.nan)
        panel.plot(time[::step], true[::step], color=RED, linewidth=0.9, linestyle="--", label="true")
    panel.set_ylabel(label)
    panel.legend(loc="best", ncols=2)


def time_plot(rows: Sequence[dict[str, Any]]) -> Plot:
    """Draw how long each pocket took, and what of that was milling, from the figures of each."""
    figure = Figure(figsize=(8.0, 0.8 + 0.45 * len(rows)))
    panel = figure.subplots()
    names = [row["name"] for row in rows]
    milling, seconds = np.array([row["milling"] for row in rows]), np.array([row["seconds"] for row in rows])
    panel.barh(names, milling, color=BLUE, label="milling")
    panel.barh(names, seconds - milling, left=milling, color=ORANGE, label="ways between")
    panel.invert_yaxis()
    panel.set_xlabel("time, s")
    panel.legend(loc="best", ncols=2)
    return Plot(figure, "The time of each pocket.")
