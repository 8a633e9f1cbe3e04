"""The report of a mid-ranging run."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from rigkit.experiment.kept import early_facts
from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from stagectl.experiments.midranging.plots import circle_plot, control_plot, error_plot, model_plot, position_plot
from stagectl.experiments.midranging.scenario import Scenario
from stagectl.robot.midranging_config import MidrangeConfig

PAGE = "report.html"


def write_report(
    path: Path,
    runs: Mapping[str, Recording],
    chosen: Mapping[str, Scenario],
    config: MidrangeConfig,
    found: Mapping[str, Any],
    png: Path | None = None,
) -> None:
    """Write `report.html` into a folder, and the figures as PNG files into another one where that is given.

    Parameters
    ----------
    path : Path
    runs, chosen : mappings of str to Recording and Scenario
        By axis.
    config : MidrangeConfig
    found : dict
        Of `all_figures`.
    png : Path, optional
    """
    with styled():
        report = _report(path, runs, chosen, config, found)
        report.write(path / PAGE)
        if png is not None:
            report.png(png)


def _report(
    path: Path,
    runs: Mapping[str, Recording],
    chosen: Mapping[str, Scenario],
    config: MidrangeConfig,
    found: Mapping[str, Any],
) -> Report:
    sections = [Section("Circle", plots=(circle_plot(runs),))] if "circle" in found else []
    for axis, each in runs.items():
        sections += _sections(axis, each, chosen[axis], config, found.get("axes", {}).get(axis, found))
    over = found["control_over_limit"]
    facts = [
        Fact("IAE", f"{1e3 * found['iae']:.4g} mm s"),
        Fact("Largest control signal over its limit", f"{over:.3f}", over <= 1.0 + 1e-9),
        Fact("Micro manipulator, largest", f"{1e3 * found['fast_peak']:.3g} mm"),
        Fact("Micro manipulator, rms", f"{1e3 * found['fast_rms']:.3g} mm"),
    ]
    if "taken_over_at" in found:
        at = found["taken_over_at"]
        facts.append(Fact("Valve position control took over", "no" if at is None else f"at {at:.3g} s", at is None))
    if "circle" in found:
        facts.append(Fact("Off the circle, mean absolute", f"{1e6 * found['circle']['mean_absolute']:.3g} µm"))
    facts += early_facts(found)
    name = next(iter(chosen.values())).name
    by = next(iter(runs.values())).provenance.get("controller", "")
    title = f"Mid-ranging{' live' if config.session.live else ''}, {by}, {name}"
    return Report(title, str(path.resolve()), tuple(facts), tuple(sections))


def _sections(
    axis: str, run: Recording, chosen: Scenario, config: MidrangeConfig, found: Mapping[str, Any]
) -> list[Section]:
    of = f", {axis}" if axis else ""
    sections = [
        Section(f"Positions{of}", plots=(position_plot(run, chosen, config),)),
        Section(f"Error{of}", plots=(error_plot(run, chosen),)),
        Section(f"Control signal{of}", plots=(control_plot(run, chosen, config),)),
    ]
    if "share" in run.names:
        tables = (_changes(found["changes"]),) if "changes" in found else ()
        sections.append(Section(f"Models{of}", plots=(model_plot(run, chosen, config),), tables=tables))
    return sections


def _changes(changes: list[dict[str, float]]) -> Table:
    head = ("gain changes at", "to, of the first", "deviation a period later, %", "gain off a period later, %")
    rows = tuple(
        (
            f"{each['time']:g} s",
            f"{each['gain']:g}",
            f"{100 * each['deviation']:.3g}",
            f"{100 * each['gain_error']:.3g}",
        )
        for each in changes
    )
    return Table(head, rows)
