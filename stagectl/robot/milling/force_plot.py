"""Estimated forces over time, with the band they are in."""

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS, styled
from stagectl.robot.milling.force_estimate import ForceEstimates

POINTS = 4_000
"""Drawn of a line, at most; of more samples, the band is that of all in between."""
AXES = ("x", "y", "z")


def force_plot(time: np.ndarray, found: ForceEstimates, measured: np.ndarray | None = None) -> Figure:
    """Draw a panel an axis.

    Parameters
    ----------
    time : array, shape (samples,), s
    found : ForceEstimates
    measured : array, shape (samples, 3), N, optional
        The same force by a sensor.
    """
    with styled():
        return _drawn(time, found, measured)


def _drawn(time: np.ndarray, found: ForceEstimates, measured: np.ndarray | None) -> Figure:
    figure = Figure(figsize=(8.0, 6.4))
    panels = figure.subplots(3, 1, sharex=True)
    every = -(-len(time) // POINTS)
    starts = np.arange(0, len(time), every)
    for place, (panel, axis) in enumerate(zip(panels, AXES, strict=True)):
        bounds = (
            np.where(np.isfinite(found.low), found.low, np.nan),
            np.where(np.isfinite(found.high), found.high, np.nan),
        )
        low, high = (
            extreme.reduceat(bound[:, place], starts) for extreme, bound in zip((np.fmin, np.fmax), bounds, strict=True)
        )
        panel.fill_between(time[starts], low, high, color=COLOURS[4], alpha=0.5, linewidth=0, label="bounds")
        if measured is not None:
            panel.plot(time[starts], measured[starts, place], color=COLOURS[1], linewidth=1.0, label="true")
        panel.plot(time[starts], found.force[starts, place], color=COLOURS[0], linewidth=0.8, label="estimated")
        panel.set_ylabel(f"force along {axis}, N")
    panels[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
    panels[-1].set_xlabel("time, s")
    return figure
