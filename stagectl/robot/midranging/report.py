"""The report of a mid-ranging run."""

from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from stagectl.robot.midranging.config import MidrangeConfig
from stagectl.robot.midranging.figures import control_plot, error_plot, model_plot, position_plot
from stagectl.robot.midranging.scenario import Scenario

PAGE = "report.html"


def write_report(
    path: Path,
    run: Recording,
    chosen: Scenario,
    config: MidrangeConfig,
    found: dict[str, Any],
    png: Path | None = None,
) -> None:
    """Write `report.html` into a folder, and the figures as PNG files into another one where that is given.

    Parameters
    ----------
    path : Path
    run : Recording
        Of `simulate`.
    chosen : Scenario
    config : MidrangeConfig
    found : dict
        Of `figures`.
    png : Path, optional
    """
    with styled():
        report = _report(path, run, chosen, config, found)
        report.write(path / PAGE)
        if png is not None:
            report.png(png)


def _report(path: Path, run: Recording, chosen: Scenario, config: MidrangeConfig, found: dict[str, Any]) -> Report:
    sections = [
        Section("Positions", plots=(position_plot(run, chosen, config),)),
        Section("Error", plots=(error_plot(run, chosen),)),
        Section("Control signal", plots=(control_plot(run, chosen, config),)),
    ]
    if "share" in run.names:
        tables = (_changes(found["changes"]),) if "changes" in found else ()
        sections.append(Section("Models", plots=(model_plot(run, chosen, config),), tables=tables))
    over = found["control_over_limit"]
    facts = [
        Fact("IAE", f"{1e3 * found['iae']:.4g} mm s"),
        Fact("Largest control signal over its limit", f"{over:.3f}", over <= 1.0 + 1e-9),
        Fact("Micro manipulator, largest", f"{1e3 * found['fast_peak']:.3g} mm"),
        Fact("Micro manipulator, rms", f"{1e3 * found['fast_rms']:.3g} mm"),
    ]
    title = f"Mid-ranging, {run.provenance.get('controller', '')}, {chosen.name}"
    return Report(title, str(path.resolve()), tuple(facts), tuple(sections))


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
