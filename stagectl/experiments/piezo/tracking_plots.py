"""How the stage followed: reference and position, the error in time, and how it is distributed."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS
from rigkit.report import Plot
from stagectl.experiments.piezo.result import BOUND, Result
from stagectl.tracking import WITHIN, tracking

SPANS = 1_000
"""Of the time axis: of each, the smallest and the largest sample are drawn."""
FEWEST_BINS, STEP = 40, 0.2
"""Bins are whole numbers of the laser's steps (µm) wide, or a tenth of one, so that steps make no comb."""


def tracking_plot(result: Result) -> Plot:
    """Draw reference and position of every axis over the run."""
    figure, panels = _panels(result, 1.7)
    for number, axes in enumerate(panels):
        for signal, colour, label in ((result.proper("position"), COLOURS[0], "position"),):
            _envelope(axes, result.time, 1e6 * signal[:, number], colour, label)
        step = max(1, len(result.time) // SPANS)
        axes.plot(
            result.time[::step],
            1e6 * result.proper("reference")[::step, number],
            color=COLOURS[1],
            linewidth=0.8,
            label="reference",
        )
        axes.set_title(f"Axis {result.axes[number]}")
        axes.set_ylabel("position, µm")
    panels[0].legend(loc="best", ncols=2)
    panels[-1].set_xlabel("time, s")
    return Plot(figure, "Reference and measured position of the plate.")


def error_plot(result: Result) -> Plot:
    """Draw the error of every axis over the run, and what it was without compensation."""
    figure, panels = _panels(result, 1.7)
    for number, axes in enumerate(panels):
        _envelope(axes, result.time, 1e6 * result.error[:, number], COLOURS[0], "error")
        for sign in (-1, 1):
            axes.axhline(sign * 1e6 * WITHIN, **BOUND)
        axes.set_title(f"Axis {result.axes[number]}")
        axes.set_ylabel("error, µm")
    panels[-1].set_xlabel("time, s")
    what = "Reference position minus laser" if result.made.config.deflection.on else "Reference less measured position"
    return Plot(figure, f"{what}, as the smallest and largest sample of short spans. Dashed: ±5 µm.")


def histogram_plot(result: Result) -> Plot:
    """Draw how the error of every axis is distributed, with its mean absolute error."""
    figure = Figure(figsize=(8.0, 3.2))
    panels = list(figure.subplots(1, len(result.axes), squeeze=False)[0])
    for number, axes in enumerate(panels):
        error = 1e6 * result.error[:, number]
        axes.hist(error, bins=_edges(error), color=COLOURS[0], density=True)
        measures = tracking(result.error[:, number])
        for sign in (-1, 1):
            axes.axvline(sign * 1e6 * WITHIN, **BOUND)
        axes.set_title(f"{result.axes[number]}: MAE {1e6 * measures.mae:.2f} µm")
        axes.set_xlabel("error, µm")
    panels[0].set_ylabel("density, 1/µm")
    return Plot(figure, "Distribution of the error over the run, with its mean absolute error. Dashed: ±5 µm.")


def _edges(error: np.ndarray) -> np.ndarray:
    """Return the bins' edges, shape (bins + 1,), µm, in the middle between two of the laser's steps."""
    largest = float(np.abs(error).max())
    width = STEP * max(1.0, np.floor(2 * largest / FEWEST_BINS / STEP)) if largest > STEP else STEP / 10
    count = int(np.ceil(largest / width)) + 1
    edges: np.ndarray = width * (np.arange(-count, count + 1) + 0.5)
    return edges


def _panels(result: Result, height: float) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(8.0, 0.7 + height * len(result.axes)))
    return figure, list(figure.subplots(len(result.axes), 1, sharex=True, squeeze=False)[:, 0])


def _envelope(axes: Axes, time: np.ndarray, values: np.ndarray, colour: str, label: str) -> None:
    span = max(1, len(values) // SPANS)
    whole = len(values) // span * span
    parts = values[:whole].reshape(-1, span)
    axes.fill_between(time[:whole:span], parts.min(axis=1), parts.max(axis=1), color=colour, linewidth=0.8, label=label)
