"""Figures over the shots of a run: error, worst line, overtones and phase."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from rigkit.figure_style import COLOURS
from rigkit.report import Plot
from vibractl.figures.lines import BOUND, legend_above
from vibractl.figures.result import Result
from vibractl.overtones import OVERTONES

MARKERS = ("o", "s", "^", "D", "v", "P", "X")


def learning_plot(result: Result) -> Plot:
    """Draw IAE and worst line of every shot, with the limit, and where the gain changes."""
    figure = Figure(figsize=(8.0, 5.2))
    error, worst = figure.subplots(2, 1, sharex=True)
    for number, side in enumerate(result.sides):
        _draw(error, result.column(f"iae_{number + 1}"), number, f"{result.sensor} {side}")
        _draw(worst, result.column(f"worst_line_db_{number + 1}"), number, f"{result.sensor} {side}")
    error.set_yscale("log")
    low, high = error.get_ylim()
    error.set_ylim(low / (high / low) ** 0.15, high)  # room for the gains
    error.set_ylabel(f"sum of |error|, {result.unit}")
    error.set_title("Integrated absolute error (IAE)")
    worst.axhline(0.0, **BOUND, label="limit")
    worst.set_ylabel("over the limit, dB")
    worst.set_title("Worst bin: below 0 dB the objective holds")
    for axes in (error, worst):
        _mark_gains(axes, result.column("gain"), named=axes is error)
        legend_above(axes)
    _shots(worst, len(result.rows))
    dotted = " Dotted: where the learning gain K of the following updates changes."
    return Plot(figure, "Error of every shot." + ("" if np.isnan(result.column("gain")).all() else dotted))


def overtone_plot(result: Result) -> Plot:
    """Draw the overtones' levels of every shot, a panel for each side on one scale."""
    figure, panels = _panels(result)
    for number, axes in enumerate(panels):
        for order in range(2, OVERTONES + 2):
            _draw(axes, result.column(f"overtone_{order}_db_{number + 1}"), order - 2, f"{order}·f")
        objective = result.made.config.quality.objective
        axes.axhline(objective, **BOUND)
        axes.set_title(f"{result.sensor.capitalize()} {result.sides[number]}: overtones")
    panels[0].set_ylabel("level re root, dB")
    panels[-1].legend(loc="best", ncols=2)
    return Plot(
        figure,
        "Overtones of the response, followed along the reference's phase and given re its root. Dashed: the objective.",
    )


def phase_plot(result: Result) -> Plot:
    """Draw mean and largest phase error of every shot, a panel for each side on one scale."""
    figure, panels = _panels(result)
    for number, axes in enumerate(panels):
        peak, mean = (result.column(f"phase_{what}_deg_{number + 1}") for what in ("peak", "mean"))
        _draw(axes, np.abs(peak), 1, "largest")
        _draw(axes, np.abs(mean), 0, "|mean|")
        axes.set_yscale("log")
        axes.set_title(f"{result.sensor.capitalize()} {result.sides[number]}: phase error")
    panels[0].set_ylabel("phase error, degrees")
    panels[-1].legend(loc="best", ncols=2)
    return Plot(figure, "Phase of the response's root against the reference's, where the reference is loud.")


def _panels(result: Result) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(8.0, 3.4))
    panels = list(figure.subplots(1, len(result.sides), sharex=True, sharey=True, squeeze=False)[0])
    for axes in panels:
        _shots(axes, len(result.rows))
    return figure, panels


def _draw(axes: Axes, values: np.ndarray, number: int, label: str) -> None:
    many = len(values) > 100
    axes.plot(
        values,
        color=COLOURS[number % len(COLOURS)],
        marker="" if many else MARKERS[number % len(MARKERS)],
        markersize=4,
        label=label,
    )


def _mark_gains(axes: Axes, gains: np.ndarray, named: bool) -> None:
    """Mark where a stage of gains begins; the update after shot k makes shot k + 1."""
    if np.isnan(gains).all():  # no law of this program
        return
    for shot in (0, *(np.flatnonzero(np.diff(gains)) + 1)):
        if shot:
            axes.axvline(shot, color="#666666", linestyle=":", linewidth=1.0)
        if named:
            axes.annotate(
                f"K = {gains[shot]:g}",
                (shot, 0.03),
                (4, 0),
                xycoords=axes.get_xaxis_transform(),
                textcoords="offset points",
                fontsize=9,
                color="#444444",
            )


def _shots(axes: Axes, shots: int) -> None:
    axes.set_xlabel("shot")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    axes.set_xlim(-0.5, max(shots - 0.5, 0.5))
