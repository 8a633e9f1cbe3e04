"""What a fitted frequency response is: rows of tables, the figures of `--json`, and a report to look at."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from calibration.frequency_domain.identify import Measured
from calibration.frequency_domain.response_model import ResponseModel
from rigkit.figure_style import COLOURS, styled
from rigkit.report import Fact, Plot, Report, Section, Table

MODE_HEAD = ("frequency, Hz", "+-", "damping ratio, %", "+-")
FIT_HEAD = ("of the fit", "")
GRID, SURE = 800, 1.96
"""Frequencies at which a model is drawn, and standard errors on either side of a 95 % band."""
MOST_DRAWN, LEAST_DRAWN = 4, 1e-5
"""Outputs, and inputs, that are drawn; the least gain, re the largest."""


def fit_rows(found: ResponseModel, measured: Measured) -> list[tuple[str, str]]:
    """Return how well it fits."""
    figures = fit_figures(found, measured)
    return [
        ("bins", f"{figures['lines']}"),
        ("error, median of bins", f"{100 * figures['relative_error_median']:.3g} %"),
        ("error, largest", f"{100 * figures['relative_error_largest']:.3g} % at {figures['largest_at_hz']:.4g} Hz"),
        ("what is left, re the stated errors", f"{figures['spread']:.3g}"),
    ]


def mode_rows(found: ResponseModel) -> list[tuple[str, ...]]:
    """Return a row a mode."""
    return [
        (
            f"{mode['frequency']:.4f}",
            f"{mode['frequency_error']:.2g}",
            f"{100 * mode['damping']:.4g}",
            f"{100 * mode['damping_error']:.2g}",
        )
        for mode in found.poles()
    ]


def fit_figures(found: ResponseModel, measured: Measured) -> dict[str, Any]:
    """Return what `--json` writes."""
    frequency, response, _ = measured
    missed = np.linalg.norm(response - found.response(frequency), axis=(1, 2)) / np.linalg.norm(response, axis=(1, 2))
    modes = found.poles()
    return {
        "order": found.order,
        "rate": found.rate,
        "band_hz": found.band,
        "lines": len(frequency),
        "relative_error_median": float(np.median(missed)),
        "relative_error_largest": float(missed.max()),
        "largest_at_hz": float(frequency[missed.argmax()]),
        "spread": found.spread,
        "modes": [{name: float(mode[name]) for name in modes.dtype.names or ()} for mode in modes],
    }


def response_report(found: ResponseModel, measured: Measured, source: str) -> Report:
    """Put the report together."""
    rows = fit_rows(found, measured)
    with styled():
        sections = (
            Section(
                "Frequency response",
                "Dots: measured. Line: the model, with its 95 % band, which holds where the order is right. "
                "Below: what is left, and the standard error of what was measured.",
                (Plot(_gains(found, measured), "Gain from each input to each output."),),
            ),
            Section("Modes", "+- is one standard error.", (), (Table(MODE_HEAD, tuple(mode_rows(found))),)),
        )
    time = "continuous time" if found.rate is None else f"{found.rate:g} samples/s"
    facts = (Fact("states", f"{found.order}"), *(Fact(*row) for row in rows))
    return Report("Frequency response", f"{source}, {time}", facts, sections)


def _gains(found: ResponseModel, measured: Measured) -> Figure:
    frequency, response, variance = measured
    outputs, inputs = (min(count, MOST_DRAWN) for count in response.shape[1:])
    grid = np.unique(np.concatenate([np.geomspace(frequency[0], frequency[-1], GRID), frequency]))
    model, errors = found.response(grid), found.errors(grid)
    left = np.abs(response - found.response(frequency))
    figure = Figure(figsize=(1.5 + 4.0 * inputs, 1.0 + 2.8 * outputs))
    axes = figure.subplots(outputs, inputs, sharex=True, squeeze=False)
    for row in range(outputs):
        for column in range(inputs):
            each, size = axes[row, column], np.abs(model[:, row, column])
            around = SURE * errors[:, row, column]
            each.fill_between(
                grid, np.maximum(size - around, 1e-3 * size), size + around, color=COLOURS[1], alpha=0.3, linewidth=0
            )
            each.loglog(
                frequency, np.abs(response[:, row, column]), ".", color=COLOURS[0], markersize=3, label="measured"
            )
            each.loglog(grid, size, color=COLOURS[1], linewidth=0.9, label="model")
            each.loglog(frequency, left[:, row, column], color=COLOURS[2], linewidth=0.6, label="what is left")
            each.loglog(
                frequency, np.sqrt(variance[:, row, column]), ":", color="0.4", linewidth=0.8, label="stated error"
            )
            each.set_title(f"input {column + 1} to output {row + 1}")
    axes[0, 0].legend(fontsize="small")
    for each in axes.flat:
        each.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        each.xaxis.set_major_formatter("{x:g}")
        each.xaxis.set_minor_formatter(NullFormatter())
        each.set_ylim(bottom=LEAST_DRAWN * np.abs(response).max())
    for each in axes[-1]:
        each.set_xlabel("Hz")
    figure.set_layout_engine("constrained")
    return figure
