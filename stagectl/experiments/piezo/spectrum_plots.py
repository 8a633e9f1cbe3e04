"""What is left of disturbances over frequency: spectra of the error, and the loops' sensitivity."""

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import welch

from rigkit.figure_style import COLOURS
from rigkit.report import Plot
from stagectl.experiments.piezo.result import BOUND, Result
from stagectl.stage.state_space import plant_of

HIGHEST = 1_000.0
"""Hz."""
LONGEST = 2**14
"""Samples of a segment."""


def spectrum_plot(result: Result) -> Plot:
    """Draw the spectral density of every axis' error, with that without compensation behind it."""
    figure = Figure(figsize=(8.0, 0.7 + 1.9 * len(result.axes)))
    panels = figure.subplots(len(result.axes), 1, sharex=True, squeeze=False)[:, 0]
    for number, axes in enumerate(panels):
        drawn = ((result.error_before, COLOURS[5], "uncompensated"), (result.error, COLOURS[0], "error"))
        for error, colour, label in drawn:
            if error is not None:
                frequency, density = welch(1e6 * error[:, number], result.record.rate, nperseg=min(LONGEST, len(error)))
                kept = (frequency > 0) & (frequency <= HIGHEST)
                axes.loglog(frequency[kept], np.sqrt(density[kept]), color=colour, label=label)
        axes.set_title(f"Axis {result.axes[number]}")
        axes.set_ylabel("µm/√Hz")
    panels[0].legend(loc="best")
    panels[-1].set_xlabel("frequency, Hz")
    return Plot(figure, "Amplitude spectral density of the error (Welch, Hann windows).")


def sensitivity_plot(result: Result) -> Plot:
    """Draw the sensitivity of every axis' outer loop on its model, with the bound on Ms."""
    figure = Figure(figsize=(8.0, 3.6))
    axes = figure.subplots()
    rate, outer = result.record.rate, result.made.config.outer
    frequency = np.geomspace(0.5, rate / 2, 2_000)
    for number, (name, design) in enumerate(zip(result.axes, result.made.designs, strict=True)):
        loop = design.loop.system().response(frequency, rate)
        loop = loop * plant_of(design.loop.model).response(frequency, rate)
        axes.loglog(frequency, np.abs(1.0 / (1.0 + loop)), color=COLOURS[number], label=name)
    axes.axhline(outer.max_sensitivity, **BOUND)
    axes.set_xlabel("frequency, Hz")
    axes.set_ylabel("|S|")
    axes.legend(loc="best")
    return Plot(figure, "Sensitivity of the outer loops on their models, without extra delay. Dashed: bound on Ms.")
