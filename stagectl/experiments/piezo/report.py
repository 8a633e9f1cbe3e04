"""The report of a run: how well it followed, what is left over frequency, drives, and the loops it ran with."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from rigkit.event_table import event_table
from rigkit.experiment.command import PAGE
from rigkit.experiment.kept import early_facts
from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from rigkit.run_folder import read_events
from stagectl.experiments.piezo.drive_plots import drive_plot, headroom_table
from stagectl.experiments.piezo.prefilter_plots import prefilter_plot, prefilter_table
from stagectl.experiments.piezo.result import Result, result_of
from stagectl.experiments.piezo.setup import Setup
from stagectl.experiments.piezo.spectrum_plots import sensitivity_plot, spectrum_plot
from stagectl.experiments.piezo.tracking_plots import error_plot, histogram_plot, tracking_plot


def run_report(
    path: Path, records: Mapping[str, Recording], made: Setup, figures: Mapping[str, Any], png: Path | None = None
) -> None:
    """Write `report.html` into a run folder, whole or not at all.

    Parameters
    ----------
    path : Path
        Run folder.
    records : mapping of str to Recording
    made : Setup
        With its designs.
    figures : mapping
        As of `figures.figures`.
    png : Path, optional
        Folder for the figures as PNG files as well.

    Raises
    ------
    ValueError : nothing of the run proper is recorded.
    """
    result = result_of(records, made)
    events = read_events(path)
    with styled():
        report = Report(
            f"{result.made.config.rig.name}, {figures['seconds']:g} s",
            str(path.resolve()),
            tuple(_facts(figures, events)),
            tuple(_sections(result, figures, events)),
        )
        report.write(path / PAGE)
        if png is not None:
            report.png(png)


def _facts(figures: Mapping[str, Any], events: list[dict[str, Any]]) -> Iterator[Fact]:
    shown = "tool_error" if "improvement" in figures or "position_error" not in figures else "position_error"
    for axis, each in figures[shown].items():
        yield Fact(f"MAE of {axis}", f"{1e6 * each['mae']:.2f} µm")
    for axis, each in figures[shown].items():
        yield Fact(f"Within ±5 µm, {axis}", f"{100 * each['within']:.1f} %", each["within"] == 1.0)
    for axis, factor in figures.get("improvement", {}).items():
        yield Fact(f"Better than uncompensated, {axis}", f"{factor:.1f} times", factor >= 1.0)
    yield from early_facts(figures)
    told = {"fault": "text", "link_fault": "reason"}  # those of a stage in process had events of their own once
    faults = [event[told[event["event"]]] for event in events if event["event"] in told]
    yield Fact("Faults", "; ".join(faults) or "none", not faults)


def _sections(result: Result, figures: Mapping[str, Any], events: list[dict[str, Any]]) -> Iterator[Section]:
    yield Section("Tracking", plots=(tracking_plot(result), error_plot(result)))
    yield Section("Error", plots=(histogram_plot(result),), tables=(_error_table(figures),))
    yield Section("Spectra", plots=(spectrum_plot(result),))
    yield Section("Drives", plots=(drive_plot(result),), tables=(headroom_table(result),))
    if result.made.designs:
        yield Section("Loops", plots=(sensitivity_plot(result),), tables=(_loop_table(result),))
    if result.made.prefilters:
        yield Section("Prefilters", plots=(prefilter_plot(result),), tables=(prefilter_table(result),))
    yield Section("Events", tables=(event_table(events),))


def _error_table(figures: Mapping[str, Any]) -> Table:
    rows = []
    for what in ("position_error", "tool_error", "uncompensated_tool_error"):
        for axis, each in figures.get(what, {}).items():
            sizes = (f"{1e6 * each[key]:.2f}" for key in ("mae", "std", "peak"))
            rows.append((f"{what.replace('_', ' ')}, {axis}", *sizes, f"{100 * each['within']:.1f}"))
    return Table(("error", "MAE, µm", "std, µm", "peak, µm", "within ±5 µm, %"), tuple(rows))


def _loop_table(result: Result) -> Table:
    rows = []
    for axis, design in zip(result.axes, result.made.designs, strict=True):
        figures, low = design.robustness, design.robustness.gain_margins
        rows.append(
            (
                axis,
                f"{design.loop.model.order}",
                f"{figures.max_sensitivity:.2f}",
                f"{design.worst_sensitivity:.2f}",
                f"{low[0]:.2f} to {low[1]:.1f}",
                f"{figures.phase_margin:.0f}",
                f"{1e6 * figures.delay_margin:.0f}",
                f"{figures.crossover:.0f}",
            )
        )
    head = (
        "axis",
        "order",
        "Ms",
        "Ms, mistuned",
        "gain margins",
        "phase margin, °",
        "delay margin, µs",
        "crossover, Hz",
    )
    return Table(head, tuple(rows))
