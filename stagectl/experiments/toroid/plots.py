"""The figures of the cell's report: the contour, its deviation, the surface, and what the stage did of its travel."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ctlblocks.recording import Recording
from rigkit.figure_style import COLOURS, LIMIT
from rigkit.report import Plot
from stagectl.devices.signals import AXES
from stagectl.experiments.toroid.measures import STEP, Contour
from stagectl.experiments.toroid.plan import SETUPS, Plan

COLOUR = dict(zip(SETUPS, COLOURS, strict=False))
"""Of every setup."""
RING = 5.0
"""Radius of the circle in the polar plot over the largest deviation."""
RING_LABELS = 60.0
"""Degrees, where the rings beside it are labelled."""
POINTS = 4_000
"""Drawn of a line, about."""


@dataclass(frozen=True, eq=False)
class Run:
    """What figures are drawn from.

    Parameters
    ----------
    plan : Plan
    records : mapping of str to Recording
    milled : Contour or None
    seen : array, shape (samples, 3), or None
        As of `figures.seen_deviation`.
    """

    plan: Plan
    records: Mapping[str, Recording]
    milled: Contour | None
    seen: np.ndarray | None = None


def polar_plot(runs: list[Run]) -> Plot:
    """Draw the outer contours around the circle, deviations magnified alike."""
    figure = Figure(figsize=(7.0, 6.4))
    axes: Any = figure.add_subplot(projection="polar")
    drawn = [run for run in runs if run.milled is not None]
    largest = max(float(np.abs(run.milled.radial).max()) for run in drawn if run.milled)
    for run in drawn:
        assert run.milled is not None
        at = _drawn(run.milled.radial)
        size = 1e6 * (run.milled.radial[at] + RING * largest)
        axes.plot(run.milled.angle[at], size, color=COLOUR[run.plan.setup], linewidth=0.9, label=run.plan.setup)
    around = np.linspace(0, 2 * np.pi, 361)
    axes.plot(around, np.full(361, 1e6 * RING * largest), label="as it is to be", **LIMIT)
    axes.set_rlim(0, 1e6 * (RING + 1.1) * largest)
    ring = _round(largest)
    axes.set_rticks([1e6 * (RING * largest + part * ring) for part in (-1, 1)])
    axes.set_yticklabels([f"{1e6 * part * ring:+.3g} µm" for part in (-1, 1)])
    axes.set_rlabel_position(RING_LABELS)
    for label in axes.get_yticklabels():
        label.set(ha="center", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0})
    axes.legend(loc="center")
    return Plot(
        figure, "Deviation of the outer contour around the circle, from y (0°) to z (90°, where the cut begins)."
    )


def deviation_plot(runs: list[Run]) -> Plot:
    """Draw the deviation of the outer contour along the circumference, a panel a setup."""
    drawn = [run for run in runs if run.milled is not None]
    figure = Figure(figsize=(8.0, 0.8 + 1.5 * len(drawn)))
    panels = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
    for panel, run in zip(panels, drawn, strict=True):
        assert run.milled is not None
        _along(panel, run, run.milled.radial)
        panel.set_title(f"Setup {run.plan.setup}")
        panel.set_ylabel("µm")
    panels[-1].set_xlabel("circumference, mm")
    return Plot(figure, "Deviation of the outer contour from the circle, fitted in place; outwards is positive.")


def surface_plot(runs: list[Run]) -> Plot:
    """Draw the surface along the path, all setups."""
    figure = Figure(figsize=(8.0, 3.6))
    axes = figure.subplots()
    for run in runs:
        if run.milled is not None:
            _along(axes, run, run.milled.axial)
    axes.set_xlabel("along the path, mm")
    axes.set_ylabel("too deep, µm")
    axes.legend(loc="best", ncols=len(runs))
    return Plot(figure, "The surface along the tool's axis.")


def seen_plot(runs: list[Run]) -> Plot:
    """Draw how far off its path the tool was seen, a panel a setup."""
    figure = Figure(figsize=(8.0, 0.8 + 2.0 * len(runs)))
    panels = figure.subplots(len(runs), 1, sharex=True, squeeze=False)[:, 0]
    for panel, run in zip(panels, runs, strict=True):
        assert run.seen is not None
        time, outwards, axial = run.seen.T
        for signal, name, colour in ((outwards, "outwards", COLOURS[0]), (axial, "along the tool", COLOURS[1])):
            panel.plot(time, 1e6 * signal, color=colour, linewidth=0.8, label=name)
        panel.set_title(f"Setup {run.plan.setup}: {SETUPS[run.plan.setup]}")
        panel.set_ylabel("µm")
    panels[0].legend(loc="best", ncols=2)
    panels[-1].set_xlabel("time, s")
    return Plot(figure, "How far off its path the tool was seen: low-passed, and no better than the tracker.")


def travel_plot(runs: list[Run]) -> Plot:
    """Draw what was asked of the stage, from the middle of its travel, with the ends."""
    figure = Figure(figsize=(8.0, 0.8 + 2.4 * len(runs)))
    panels = figure.subplots(len(runs), 1, sharex=True, squeeze=False)[:, 0]
    for panel, run in zip(panels, runs, strict=True):
        record = run.records["cell"]
        wished = record.select([f"fast_reference_{axis}" for axis in AXES]).data
        time, low, high = np.arange(len(wished)) / record.rate, *run.plan.stage.limits.travel
        for axis, signal, colour in zip(AXES, wished.T, COLOURS, strict=False):
            panel.plot(time[::4], 1e6 * signal[::4], color=colour, linewidth=0.8, label=axis)
        for sign in (-1, 1):
            panel.axhline(sign * 1e6 * (high - low) / 2, **LIMIT)
        panel.set_title(f"Setup {run.plan.setup}: {SETUPS[run.plan.setup]}")
        panel.set_ylabel("µm")
    panels[0].legend(loc="best", ncols=3)
    panels[-1].set_xlabel("time, s")
    return Plot(figure, "Reference of the stage, from the middle of its travel. Dashed: its ends.")


def _along(axes: Axes, run: Run, signal: np.ndarray) -> None:
    at, setup = _drawn(signal), run.plan.setup
    axes.plot(1e3 * STEP * at, 1e6 * signal[at], color=COLOUR[setup], linewidth=0.8, label=setup)


def _drawn(signal: np.ndarray) -> np.ndarray:
    """Return which points of a line, shape (points,), are drawn: of each span the lowest and the highest."""
    span = max(1, 2 * len(signal) // POINTS)
    spans = signal[: len(signal) // span * span].reshape(-1, span)
    first = span * np.arange(len(spans))
    return np.unique(np.concatenate([first + spans.argmin(axis=1), first + spans.argmax(axis=1)]))


def _round(size: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten that is no larger than a size > 0."""
    power = 10.0 ** np.floor(np.log10(size))
    return float(power * max(each for each in (1, 2, 5) if each * power <= size))
