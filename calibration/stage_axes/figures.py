"""Figures of an axis' calibration: singular values, responses, cross coupling, the free run on fresh data."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from calibration.identification.workflow import Identification
from calibration.stage_axes.calibration import AxisCalibration
from calibration.stage_axes.order import MARGIN, MOST
from calibration.welch import FrequencyResponse, frequency_response, spectra
from rigkit.figure_style import COLOURS, LIMIT

RESOLUTION, SEGMENTS = 0.5, 4
"""Hz, of Welch's spectra; coarser where a record has not so many segments of it."""
DRAWN = 4_000
"""Points of a record that are drawn at most."""


def order_figure(found: AxisCalibration) -> Figure:
    """Draw singular values and held-back fits against the order, open loop, closed loop and all positions."""
    columns = (("open", found.opened.one), ("closed", found.closed.one), ("closed, all positions", found.closed.every))
    figure = Figure(figsize=(9.0, 5.0))
    grid = figure.subplots(2, len(columns), sharex=True, squeeze=False)
    for (title, each), upper, lower in zip(columns, grid[0], grid[1], strict=True):
        values, order = each.started.singular_values[: MOST + 1], each.model.order
        number = np.arange(1, len(values) + 1)
        upper.semilogy(number[:order], values[:order], "o", color=COLOURS[0], markersize=4)
        upper.semilogy(number[order:], values[order:], "o", color=COLOURS[1], markersize=3)
        upper.set_title(f"{title}: {order}")
        fits = [(tried.order, tried.free_run) for tried in each.started.candidates]
        lower.plot(*zip(*fits, strict=True), "o-", color=COLOURS[2], markersize=3)
        best = max(fit for _, fit in fits)
        lower.axhline(best - MARGIN, **LIMIT)
        lower.set(ylim=(max(best - 40, 0), 101), xlabel="order")
        for axes in (upper, lower):
            axes.axvline(order + 0.5, **LIMIT)
    grid[0, 0].set_ylabel("singular value")
    grid[1, 0].set_ylabel("validation, %")
    return figure


def response_figure(found: AxisCalibration) -> Figure:
    """Draw gain and phase of both models over Welch's estimates from the fresh chirps, and the coherence."""
    figure = Figure(figsize=(9.0, 6.5))
    grid = figure.subplots(3, 2, sharex=True, squeeze=False, height_ratios=[2, 1, 1])
    for column, (title, each, unit) in enumerate(
        (("voltage to position", found.opened.one, "m/V"), ("reference to position", found.closed.one, "m/m"))
    ):
        gain, phase, coherence = grid[:, column]
        measured = _measured(each)
        band = (measured.frequency > 0) & (measured.frequency <= found.top)
        frequency = np.geomspace(measured.frequency[band][0], found.top, 2000)
        modelled = each.model.frequency_response(frequency)[:, 0, 0]
        gain.loglog(measured.frequency[band], np.abs(measured.response[band, 0, 0]), ".", markersize=3, label="Welch")
        gain.loglog(frequency, np.abs(modelled), color=COLOURS[1], label=f"model, order {each.model.order}")
        gain.set(title=title, ylabel=unit)
        gain.legend()
        phase.semilogx(measured.frequency[band], _degrees(measured.response[band, 0, 0]), ".", markersize=3)
        phase.semilogx(frequency, _degrees(modelled), color=COLOURS[1])
        phase.set(ylabel="degrees", ylim=(-190, 190), yticks=(-180, 0, 180))
        coherence.semilogx(measured.frequency[band], measured.coherence[band, 0], ".", markersize=3)
        coherence.set(ylabel="coherence", ylim=(0, 1.05), xlabel="Hz")
    return figure


def coupling_figure(found: AxisCalibration) -> Figure:
    """Draw the gain from the reference to every axis' position, over Welch's estimates."""
    each = found.closed.every
    measured = _measured(each)
    band = (measured.frequency > 0) & (measured.frequency <= found.top)
    frequency = np.geomspace(measured.frequency[band][0], found.top, 2000)
    modelled = each.model.frequency_response(frequency)
    figure = Figure(figsize=(8.0, 4.5))
    axes = figure.subplots()
    for row, name in enumerate(each.model.output_names):
        colour = COLOURS[row % len(COLOURS)]
        axes.loglog(measured.frequency[band], np.abs(measured.response[band, row, 0]), ".", markersize=3, color=colour)
        axes.loglog(frequency, np.abs(modelled[:, row, 0]), color=colour, label=name)
    axes.set(xlabel="Hz", ylabel="m/m")
    axes.legend()
    return figure


def free_run_figure(found: AxisCalibration) -> Figure:
    """Draw the fresh chirps: measured, free run and difference."""
    figure = Figure(figsize=(9.0, 5.5))
    upper, lower = figure.subplots(2, 1)
    for axes, title, each in (
        (upper, "open", found.opened.one),
        (lower, "closed", found.closed.one),
    ):
        _free_run(axes, title, each)
    lower.set_xlabel("s")
    upper.legend(ncols=3)
    return figure


def _free_run(axes: Axes, title: str, found: Identification) -> None:
    step = max(1, len(found.response) // DRAWN)
    time = np.arange(0, len(found.response), step) / found.model.rate
    measured, modelled = 1e6 * found.response[::step, 0], 1e6 * found.free_run[::step, 0]
    axes.plot(time, measured, color=COLOURS[0], linewidth=0.6, label="measured")
    axes.plot(time, modelled, color=COLOURS[1], linewidth=0.5, label="free run")
    axes.plot(time, measured - modelled, color=COLOURS[6], linewidth=0.6, label="difference")
    axes.set_title(f"{title}: {found.fresh.free_run.nrmse[0]:.2f} %")
    axes.set_ylabel("µm")


def _measured(found: Identification) -> FrequencyResponse:
    rate = found.model.rate
    resolution = max(RESOLUTION, SEGMENTS * rate / len(found.drive))
    return frequency_response(spectra(found.drive, found.response, rate, resolution))


def _degrees(response: np.ndarray) -> np.ndarray:
    angle: np.ndarray = np.degrees(np.angle(response))
    return angle
