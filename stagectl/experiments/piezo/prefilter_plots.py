"""What loops leave of a deflection over frequency, with their prefilters and without."""

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS
from rigkit.report import Plot, Table
from stagectl.experiments.piezo.lasers import lateness
from stagectl.experiments.piezo.result import Result
from stagectl.stage.prefilter import HIGHEST, LOWEST, missed

HEAD = "axis", "left, %", "without prefilter, %", "l_r, m/m", "without"


def prefilter_plot(result: Result) -> Plot:
    """Draw what every axis' loop leaves of a deflection, on its model."""
    made, figure = result.made, Figure(figsize=(8.0, 3.6))
    axes, frequency = figure.subplots(), np.geomspace(LOWEST, HIGHEST, 1_000)
    late = lateness(made.config)
    for number, (name, design, each) in enumerate(zip(result.axes, made.designs, made.prefilters, strict=True)):
        colour = COLOURS[number % len(COLOURS)]
        axes.loglog(frequency, missed(design.loop, each, late, frequency), color=colour, label=name)
        axes.loglog(frequency, missed(design.loop, None, late, frequency), color=colour, linestyle=":")
    axes.axhline(1.0, color="0.6", linewidth=0.8)
    axes.set(xlabel="frequency, Hz", ylabel="left of a deflection")
    axes.legend(loc="best")
    return Plot(
        figure,
        "Sensitivity of loop and prefilter to a deflection, on the axes' models; dotted: the loop as designed, without "
        "prefilter. Above the line the deflection is amplified: the design allows this where the measured deflection "
        "has little power.",
    )


def prefilter_table(result: Result) -> Table:
    """Return what is foreseen to be left of the deflection that each prefilter was made for."""
    rows = []
    for axis, design, each in zip(result.axes, result.made.designs, result.made.prefilters, strict=True):
        now = design.loop.forward
        if each is None:
            rows.append((axis, "no prefilter: the loop alone does as well", "", "", f"{now:.3g}"))
        else:
            parts = f"{100 * each.left:.0f}", f"{100 * each.without:.0f}"
            rows.append((axis, *parts, f"{each.forward:.3g}", f"{now:.3g}"))
    return Table(HEAD, tuple(rows))
