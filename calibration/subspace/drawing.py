"""Figures of a model and of what it makes of records; matplotlib is imported here alone."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from calibration.state_space.model import InnovationModel
from calibration.state_space.response_errors import ResponseErrors
from calibration.subspace.comparison import Comparison
from calibration.subspace.order import Candidate
from rigkit.figure_style import COLOURS, LIMIT, styled

SHOWN = 2000
"""Samples of a record that are drawn at most."""
LEAST = 1e-3
"""%, below which errors are not told apart in a figure."""
UNKNOWN = 180.0
"""Degrees either way: of such a phase nothing is known."""
SURE = 1.96
"""Standard errors either way that hold the truth nineteen times of twenty."""


def bode_figure(model: InnovationModel, grid: np.ndarray, errors: ResponseErrors | None = None) -> Figure:
    """Draw gain and phase from each input to each output; where there are none, the outputs' amplitude densities.

    Parameters
    ----------
    model : InnovationModel
    grid : array, shape (bins,), Hz
    errors : ResponseErrors, optional
        At these frequencies: the band in which the plant's response is nineteen times of twenty is shaded.
    """
    with styled():
        return _bode(model, grid, errors) if model.inputs else _densities(model, grid)


def _densities(model: InnovationModel, grid: np.ndarray) -> Figure:
    density = np.sqrt(np.einsum("bpp->bp", model.spectrum(grid)).real)
    figure = Figure(figsize=(6.5, 1.0 + 2.4 * model.outputs), layout="constrained")
    rows = figure.subplots(model.outputs, 1, sharex=True, squeeze=False)[:, 0]
    for axes, name, unit, values in zip(rows, model.output_names, model.output_units, density.T, strict=True):
        axes.loglog(grid, values, color=COLOURS[0])
        axes.set_title(f"amplitude density of {name}")
        axes.set_ylabel(f"{unit} / sqrt(Hz)")
        axes.grid(visible=True, which="both", linewidth=0.3)
    rows[-1].set_xlabel("Hz")
    return figure


def _bode(model: InnovationModel, grid: np.ndarray, errors: ResponseErrors | None) -> Figure:
    response = model.frequency_response(grid)
    figure = Figure(figsize=(1.5 + 4.0 * model.inputs, 1.0 + 3.4 * model.outputs))
    axes = figure.subplots(2 * model.outputs, model.inputs, sharex=True, squeeze=False)
    for output, (name, unit) in enumerate(zip(model.output_names, model.output_units, strict=True)):
        for drive, (source, per) in enumerate(zip(model.input_names, model.input_units, strict=True)):
            gain, phase = axes[2 * output, drive], axes[2 * output + 1, drive]
            element = response[:, output, drive]
            size, angle = np.abs(element), np.degrees(np.unwrap(np.angle(element)))
            gain.loglog(grid, size, color=COLOURS[0])
            phase.semilogx(grid, angle, color=COLOURS[0])
            if errors is not None:
                limits = gain.get_ylim()
                _shade(gain, grid, size, SURE * errors.magnitude[:, output, drive])
                _shade(phase, grid, angle, np.minimum(SURE * np.degrees(errors.phase[:, output, drive]), UNKNOWN))
                gain.set_ylim(limits)
            gain.set_title(f"{source} to {name}")
            gain.set_ylabel(f"{unit}/{per}" if (unit, per) != ("1", "1") else "gain")
            phase.set_ylabel("degrees")
            for each in (gain, phase):
                each.grid(visible=True, which="both", linewidth=0.3)
    for each in axes[-1]:
        each.set_xlabel("Hz")
    figure.set_layout_engine("constrained")
    return figure


def _shade(axes: Axes, grid: np.ndarray, values: np.ndarray, either_way: np.ndarray) -> None:
    low = values - either_way
    if axes.get_yscale() == "log":
        low = np.maximum(low, np.finfo(float).tiny)
    axes.fill_between(grid, low, values + either_way, color=COLOURS[0], alpha=0.25, linewidth=0)


def candidates_figure(candidates: Sequence[Candidate], order: int, horizon: int, runs_free: bool) -> Figure:
    """Draw what each order and horizon that was tried left of blocks that were held out.

    Parameters
    ----------
    candidates : sequence of Candidate
    order, horizon : int
        Those that were taken.
    runs_free : bool
        Whether there is a free run, and not the prediction alone.
    """
    with styled():
        figure = Figure(figsize=(6.5, 3.4), layout="constrained")
        axes = figure.subplots(1, 1, squeeze=False)[0, 0]
        kinds = ("free_run", "one_step") if runs_free else ("one_step",)
        for kind, colour in zip(kinds, COLOURS, strict=False):
            for reach in sorted({each.horizon for each in candidates}):
                at = sorted((each for each in candidates if each.horizon == reach), key=lambda each: each.order)
                left = [100 - getattr(each, kind) for each in at]
                name = kind.replace("_", " ") if reach == horizon else None
                axes.semilogy(
                    [each.order for each in at],
                    np.maximum(left, LEAST),
                    "o-",
                    color=colour,
                    label=name,
                    markersize=3,
                    linewidth=1.5 if reach == horizon else 0.5,
                    alpha=1.0 if reach == horizon else 0.35,
                )
        axes.axvline(order, label=f"order {order}, horizon {horizon}", **LIMIT)
        axes.set(xlabel="order", ylabel="left of what was held out, %")
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.grid(visible=True, which="both", linewidth=0.3)
        axes.legend()
        return figure


def comparison_figure(comparison: Comparison) -> Figure:
    """Draw the first record: what was measured, the free run (the prediction without inputs), and the difference."""
    model, measured, own = comparison.model, comparison.responses[0], comparison.fit
    if model.inputs and model.is_stable:
        modelled, fit, kind = comparison.free_run[0], own.free_run, "free run"
    else:
        modelled, fit, kind = measured - comparison.residuals[0], own.one_step, "one step ahead"
    with styled():
        figure = free_run_figure(model, measured[:SHOWN], modelled[:SHOWN], fit.nrmse, kind)
    figure.set_layout_engine("constrained")
    return figure


def free_run_figure(
    model: InnovationModel, measured: np.ndarray, modelled: np.ndarray, nrmse: np.ndarray, kind: str = "free run"
) -> Figure:
    """Draw what was measured, what the free run gives, and the difference, output by output.

    Parameters
    ----------
    model : InnovationModel
    measured, modelled : arrays, shape (N, rows), the outputs' units
        Of the first outputs.
    nrmse : array, shape (p,), %
        What stands in the titles.
    kind : str, optional
        What the model gives, in the legend.
    """
    samples, rows = measured.shape
    time = np.arange(samples) / model.rate
    figure = Figure(figsize=(8.0, 1.2 + 2.2 * rows))
    grid = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    for row, axes in enumerate(grid):
        axes.plot(time, measured[:, row], color=COLOURS[0], linewidth=1.0, label="measured")
        axes.plot(time, modelled[:, row], color=COLOURS[1], linewidth=0.9, linestyle="--", label=kind)
        axes.plot(time, measured[:, row] - modelled[:, row], color=COLOURS[2], linewidth=0.7, label="difference")
        axes.set_title(f"{model.output_names[row]}: {nrmse[row]:.2f} %")
        axes.set_ylabel(model.output_units[row])
    grid[0].legend(ncols=3)
    grid[-1].set_xlabel("s")
    return figure
