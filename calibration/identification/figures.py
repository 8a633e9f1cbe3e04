"""Figures of an identification: singular values, the model's response on fresh data, correlations of residuals."""

import numpy as np
from matplotlib.figure import Figure

from calibration.identification.workflow import Identification
from calibration.subspace import drawing
from rigkit.figure_style import COLOURS, LIMIT

SHOWN = 500
"""Samples of the free run drawn; more would hide the difference."""

ROUNDING = 1e-12
"""Singular values below this part of the largest are not drawn."""

MOST_ROWS = 6
"""Outputs drawn; the others are in the tables."""


def singular_value_figure(found: Identification) -> Figure:
    """Draw the singular values, those of the order in one colour, the rest in another."""
    values, order = found.started.singular_values, found.order
    values = values[values > ROUNDING * values[0]]
    figure = Figure()
    axes = figure.subplots(1, 1, squeeze=False)[0, 0]
    number = np.arange(1, len(values) + 1)
    axes.semilogy(number[:order], values[:order], "o", color=COLOURS[0], markersize=4, label="in the model")
    axes.semilogy(number[order:], values[order:], "o", color=COLOURS[1], markersize=3, label="left out")
    axes.axvline(order + 0.5, label=f"order {order}", **LIMIT)
    axes.set(xlabel="number", ylabel="singular value")
    axes.legend()
    return figure


def free_run_figure(found: Identification) -> Figure:
    """Draw what was measured on fresh data, what the free run (the prediction without inputs) gives, and the rest."""
    shown, fresh = (slice(SHOWN), slice(MOST_ROWS)), found.fresh
    fit, kind = (fresh.free_run, "free run") if found.runs_free else (fresh.one_step, "one step ahead")
    return drawing.free_run_figure(found.model, found.response[shown], found.free_run[shown], fit.nrmse, kind)


def residual_figure(found: Identification) -> Figure:
    """Draw the correlations of the residuals one step ahead with their past and with a drive, on fresh data."""
    model, white, cross = found.model, found.fresh.whiteness, found.fresh.cross_correlation
    rows = min(model.outputs, MOST_ROWS)
    figure = Figure(figsize=(8.0, 1.2 + 2.0 * rows))
    grid = figure.subplots(rows, 2 if model.inputs else 1, sharex="col", squeeze=False)
    lags = np.arange(1, len(white.correlation) + 1)
    for row, own in enumerate(grid[:, 0]):
        own.vlines(lags, 0, white.correlation[:, row, row], color=COLOURS[0], linewidth=2)
        for side in (-1, 1):
            own.axhline(side * white.bound, **LIMIT)
        own.set(title=model.output_names[row], ylabel="with its past")
    for row, other in enumerate(grid[:, 1] if model.inputs else ()):
        for drive in range(model.inputs):
            colour = COLOURS[drive % len(COLOURS)]
            other.plot(cross.lag, cross.correlation[:, row, drive], color=colour, label=model.input_names[drive])
        for side in (-1, 1):
            other.axhline(side * float(cross.bound[row].max()), **LIMIT)
        other.set(ylabel="with the drive")
    if model.inputs:
        grid[0, 1].legend()
    for axes in grid[-1]:
        axes.set_xlabel("lag, samples")
    return figure
