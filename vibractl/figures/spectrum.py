"""Spectra of the first and the last shot, against the limit that the objective sets."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS
from rigkit.report import Plot
from vibractl.decibels import decibels
from vibractl.figures.lines import BOUND, REFERENCE, largest_by_span, legend_above, look
from vibractl.figures.result import Result

FLOOR = -90.0
"""dB, lower end of the scale."""


def response_plot(result: Result) -> Plot:
    """Draw the responses' spectra over the whole band, with the reference's; a row for each side."""
    figure, rows = _rows(result)
    for side, axes in enumerate(rows):
        for shot in result.ends:
            _draw(axes, result, (result.reference - shot.error)[:, side], side, look(result, shot))
        _draw(axes, result, result.reference[:, side], side, {**REFERENCE, "zorder": 4})
        axes.set_title(f"{result.sensor.capitalize()} {result.sides[side]}: response")
    _finish(rows, "level re reference, dB", FLOOR)
    return Plot(
        figure,
        f"Spectra of the response; 0 dB is the reference's own level, {_level(result)}. Dashed: the objective. "
        "Where a point of the figure represents several bins, it shows the largest.",
    )


def error_plot(result: Result) -> Plot:
    """Draw the errors' spectra where they are judged, and mark the line nearest to the limit or farthest above."""
    figure, rows = _rows(result)
    judge, sine = result.judge, result.made.reference.root is not None
    frequency = judge.frequency[judge.judged]
    for side, axes in enumerate(rows):
        for shot in result.ends:
            size = np.abs(judge.lines(shot.error)[:, side]) / judge.reference_level[side]
            style = look(result, shot)
            if not sine:
                axes.plot(*_in_decibels(*largest_by_span(frequency, size[judge.judged])), linewidth=0.8, **style)
            else:
                axes.plot(frequency, decibels(size[judge.judged]), "o", markersize=6, **style)
            if shot is result.last:
                where = _mark_worst(axes, frequency, decibels(size[judge.judged]))
                axes.set_title(f"{result.sensor.capitalize()} {result.sides[side]}: worst {where}")
        if sine:
            axes.set_xticks(frequency)
    _finish(rows, "error re reference, dB", -np.inf if sine else FLOOR)
    what = "the root's overtones" if sine else f"every bin from {frequency[0]:g} to {frequency[-1]:g} Hz"
    return Plot(
        figure,
        f"What is judged: the error on {what}. Below the dashed limit the objective holds; ring: the worst bin.",
    )


def _level(result: Result) -> str:
    """Say what 0 dB are."""
    levels = " and ".join(f"{level:.3g}" for level in result.judge.reference_level)
    return f"{levels} {result.unit} s"


def _rows(result: Result) -> tuple[Figure, list[Axes]]:
    sides = len(result.sides)
    figure = Figure(figsize=(8.0, 0.7 + 2.4 * sides))
    rows = list(figure.subplots(sides, 1, sharex=True, sharey=True, squeeze=False)[:, 0])
    quality, root = result.made.config.quality, result.made.reference.root
    span = (quality.above, quality.judged_to)
    if root is not None:
        judged = result.judge.frequency[result.judge.judged]
        span = (judged[0] - root / 2, judged[-1] + root / 2)
    for axes in rows:
        axes.plot(span, (quality.objective,) * 2, **BOUND, label=f"objective, {quality.objective:g} dB", zorder=5)
    return figure, rows


def _finish(rows: list[Axes], label: str, floor: float) -> None:
    for axes in rows:
        axes.set_ylabel(label)
        axes.set_ylim(bottom=max(floor, axes.get_ylim()[0]))
    rows[-1].set_xlabel("frequency, Hz")
    rows[0].margins(x=0.01)
    legend_above(rows[0])


def _draw(axes: Axes, result: Result, signal: np.ndarray, side: int, style: dict[str, Any]) -> None:
    """Draw one side's signal; all sides go through the judge's transform, which has room for all."""
    every = np.zeros((len(signal), len(result.sides)))
    every[:, side] = signal
    size = np.abs(result.judge.lines(every)[:, side]) / result.judge.reference_level[side]
    axes.plot(*_in_decibels(*largest_by_span(result.judge.frequency, size)), **{"linewidth": 0.8, **style})


def _in_decibels(frequency: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return frequency, decibels(size)


def _mark_worst(axes: Axes, frequency: np.ndarray, level: np.ndarray) -> str:
    """Put a ring around the worst line, and say where it is."""
    worst = int(np.argmax(level))
    axes.plot(
        frequency[worst],
        level[worst],
        "o",
        markersize=9,
        markerfacecolor="none",
        markeredgecolor=COLOURS[6],
        markeredgewidth=1.3,
        zorder=6,
    )
    return f"{level[worst]:.1f} dB at {frequency[worst]:.1f} Hz"
