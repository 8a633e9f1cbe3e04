"""What a fit of hysteresis found: rows of a table, the figures of `--json`, and a report to look at."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from calibration.fit_measures import nrmse
from calibration.hysteresis import HysteresisFit
from rigkit.figure_style import COLOURS, styled
from rigkit.report import Fact, Plot, Report, Section, Table
from stagectl.stage.hysteresis import respond

FIT_HEAD = ("samples", "model NRMSE, %", "rms, µm", "straight line NRMSE, %", "rms, µm")
MOST_DRAWN = 4000
"""Samples of a curve."""


@dataclass(frozen=True)
class Judged:
    """A fit beside the record.

    Parameters
    ----------
    found : HysteresisFit
    voltage : array, shape (samples,), V
    moved : array, shape (samples,), m
    straight : array, shape (samples,), m
        The straight line that fits the fitted samples best.
    opening : float, 1
        Of the model's loop over its whole range of voltage, without lag, over its span.
    """

    found: HysteresisFit
    voltage: np.ndarray
    moved: np.ndarray
    straight: np.ndarray
    opening: float

    @property
    def held_back(self) -> slice:
        """The samples after those that were fitted."""
        return slice(self.found.fitted.stop, None)


def judged(found: HysteresisFit, voltage: np.ndarray, moved: np.ndarray) -> Judged:
    """Put a fit beside the record it was fitted to a part of.

    Parameters
    ----------
    found : HysteresisFit
        Its `fitted` has a start and a stop.
    voltage : array, shape (samples,), V
    moved : array, shape (samples,), m
    """
    line = np.polyfit(voltage[found.fitted], moved[found.fitted], 1)
    model = found.model.without_dynamics()
    up = np.linspace(model.low, model.high, 1001)
    loop = respond(model, np.concatenate([up, up[::-1], up, up[::-1]]), start=model.low)[2002:]
    opening = np.max(loop[1001:][::-1] - loop[:1001]) / np.ptp(loop)
    return Judged(found, voltage, moved, np.polyval(line, voltage), float(opening))


def fit_rows(result: Judged) -> list[tuple[str, ...]]:
    """Return a row for the samples fitted and one for the validation data."""
    rows = []
    for name, part in (("fitted", result.found.fitted), ("validation", result.held_back)):
        cells = [name]
        for curve in (result.found.modelled, result.straight):
            share, rms = _measures(result, curve, part)
            cells += [f"{share:.2f}", f"{1e6 * rms:.4g}"]
        rows.append(tuple(cells))
    return rows


def hysteresis_figures(result: Judged) -> dict[str, Any]:
    """Return what `--json` writes."""
    model = result.found.model
    figures: dict[str, Any] = {}
    for name, part in (("fitted", result.found.fitted), ("held_back", result.held_back)):
        share, rms = _measures(result, result.found.modelled, part)
        figures |= {f"{name}_nrmse_percent": share, f"{name}_rms_m": rms}
    return figures | {
        "straight_line_nrmse_percent": _measures(result, result.straight, result.held_back)[0],
        "opening_of_span": result.opening,
        "voltage_range_v": [model.low, model.high],
        "lag_s": model.lag,
        "delay_samples": model.delay,
        "cubic_m": model.cubic,
        "rising": model.rising,
        "falling": model.falling,
        "thresholds": model.thresholds,
        "weights_m": model.weights,
    }


def hysteresis_report(result: Judged, source: str) -> Report:
    """Put the report of a fit together."""
    share, rms = _measures(result, result.found.modelled, result.held_back)
    straight, _ = _measures(result, result.straight, result.held_back)
    facts = (
        Fact("validation: NRMSE", f"{share:.2f} %"),
        Fact("validation: rms", f"{1e6 * rms:.3g} µm"),
        Fact("a straight line: NRMSE", f"{straight:.1f} %"),
        Fact("loop over its span", f"{100 * result.opening:.1f} %"),
    )
    with styled():
        sections = (
            Section(
                "Loops",
                "Validation data: measured, and the model's free run from the record's start.",
                (Plot(_loops(result), "Response over voltage, measured and modelled."),),
                (Table(FIT_HEAD, tuple(fit_rows(result))),),
            ),
            Section(
                "What is left",
                "A slow trend is creep, which the model has none of; what goes with the cycles is shape or rate.",
                (
                    Plot(
                        _left_over(result), "Measured less modelled over the whole record; the shaded part was fitted."
                    ),
                ),
            ),
            Section(
                "Model",
                "Each play weighs what it adds to the response per unit of x, which goes from -1 to 1 over the range.",
                (Plot(_weights(result), "Weights over thresholds."),),
            ),
        )
    return Report("Hysteresis", source, facts, sections)


def _measures(result: Judged, curve: np.ndarray, part: slice) -> tuple[float, float]:
    """Return NRMSE, %, and rms, m, of a curve over a part of the record."""
    measured, modelled = result.moved[part], curve[part]
    share = float(nrmse(measured[:, None], modelled[:, None])[0])
    return share, float(np.sqrt(np.mean((measured - modelled) ** 2)))


def _loops(result: Judged) -> Figure:
    figure = Figure(figsize=(8.0, 5.0))
    axes = figure.subplots()
    part = slice(result.held_back.start, min(result.held_back.start + MOST_DRAWN, len(result.moved)))
    axes.plot(result.voltage[part], 1e6 * result.moved[part], label="measured")
    axes.plot(result.voltage[part], 1e6 * result.found.modelled[part], "--", label="model")
    axes.set(xlabel="voltage (V)", ylabel="response (µm)")
    axes.legend()
    return figure


def _left_over(result: Judged) -> Figure:
    figure = Figure()
    axes = figure.subplots()
    rate = result.found.model.rate
    shown = slice(None, None, max(1, len(result.moved) // MOST_DRAWN))
    time = np.arange(len(result.moved)) / rate
    axes.plot(time[shown], 1e6 * (result.moved - result.found.modelled)[shown])
    fitted = result.found.fitted
    axes.axvspan(fitted.start / rate, fitted.stop / rate, color=COLOURS[4], alpha=0.15)
    within = 1e6 * np.ptp((result.moved - result.found.modelled)[fitted.start :])
    axes.set(xlabel="time (s)", ylabel="measured less model (µm)", ylim=(-within, within))
    return figure


def _weights(result: Judged) -> Figure:
    figure = Figure()
    axes = figure.subplots()
    model = result.found.model
    axes.stem(model.thresholds, 1e6 * model.weights, basefmt=" ")
    axes.set(xlabel="threshold (x)", ylabel="weight (µm)")
    return figure
