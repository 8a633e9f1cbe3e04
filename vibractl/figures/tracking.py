"""How the response follows the reference in time: a short stretch of it, and the error of the whole shot."""

import numpy as np
from matplotlib.figure import Figure
from scipy.ndimage import uniform_filter1d

from rigkit.report import Plot
from vibractl.figures.lines import REFERENCE, draw_envelope, legend_above, look
from vibractl.figures.result import Result

STRETCH = 0.15
"""s: some ten periods."""


def tracking_plot(result: Result) -> Plot:
    """Draw response and reference over a short stretch, a row for each side and a column for each shot."""
    sides, ends = result.sides, result.ends
    figure = Figure(figsize=(8.0, 0.7 + 2.0 * len(sides)))
    grid = figure.subplots(len(sides), len(ends), sharex=True, sharey=True, squeeze=False)
    part = _loudest(result.reference, round(STRETCH * result.rate))
    time = np.arange(part.start, part.stop) / result.rate
    for row, side in enumerate(sides):
        for column, shot in enumerate(ends):
            axes = grid[row, column]
            measured = (result.reference - shot.error)[part, row]
            axes.plot(time, measured, **{**look(result, shot), "label": "response"})
            axes.plot(time, result.reference[part, row], **{**REFERENCE, "linestyle": (0, (4, 2)), "zorder": 4})
            axes.set_title(f"{result.sensor.capitalize()} {side}, shot {shot.number}")
    for axes in grid[-1]:
        axes.set_xlabel("time, s")
    for axes in grid[:, 0]:
        axes.set_ylabel(result.unit)
    for axes in grid[0]:
        legend_above(axes)
        axes.margins(x=0)
    return Plot(figure, f"Response and reference, {STRETCH:g} s of it where it is loud.")


def error_time_plot(result: Result) -> Plot:
    """Draw the error over the whole reference, a row for each side and a column for each shot, on one scale."""
    figure = Figure(figsize=(8.0, 0.7 + 1.9 * len(result.sides)))
    grid = figure.subplots(len(result.sides), len(result.ends), sharex=True, sharey=True, squeeze=False)
    time = np.arange(len(result.reference)) / result.rate
    for number, side in enumerate(result.sides):
        for axes, shot in zip(grid[number], result.ends, strict=True):
            draw_envelope(axes, time, shot.error[:, number], look(result, shot))
            peak = np.abs(shot.error[:, number]).max()
            axes.set_title(f"{result.sensor.capitalize()} {side}, shot {shot.number}: peak {peak:.2g} {result.unit}")
            axes.set_xlim(0, result.seconds)
        grid[number, 0].set_ylabel(f"error, {result.unit}")
    for axes in grid[-1]:
        axes.set_xlabel("time, s")
    return Plot(figure, "Reference minus response over the shot, as the smallest and largest sample of short spans.")


def _loudest(reference: np.ndarray, samples: int) -> slice:
    """Return the stretch of so many samples that is loudest; of equals, the one nearest to the middle."""
    samples = min(samples, len(reference))
    power = uniform_filter1d(np.square(reference).sum(axis=1), samples, mode="constant")
    loud = np.flatnonzero(power >= 0.8 * power.max())
    centre = int(loud[np.argmin(np.abs(loud - len(reference) // 2))])
    first = min(max(centre - samples // 2, 0), len(reference) - samples)
    return slice(first, first + samples)
