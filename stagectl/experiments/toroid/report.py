"""The report of the cell's runs: a table like Table 2.3, the contours, the surface, and the stage's travel."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from rigkit.event_table import event_table
from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from rigkit.run_folder import read_events
from stagectl.experiments.toroid.event_text import event_text
from stagectl.experiments.toroid.figures import milled_contour, seen_deviation
from stagectl.experiments.toroid.plan import Plan
from stagectl.experiments.toroid.plots import Run, deviation_plot, polar_plot, seen_plot, surface_plot, travel_plot

PAGE = "report.html"
HEAD = (
    "µm", "MAE, circle", "σ, circle", "largest", "σ, surface", "roughness", "turned, mrad", "travel used",
    "at an end, s", "held because",
)  # fmt: skip


def write_report(
    path: Path, found: Sequence[tuple[Plan, Mapping[str, Recording]]], rows: list[dict[str, Any]], png: Path | None
) -> None:
    """Write `report.html` into a folder, and the figures as PNG files into another one where that is given.

    Parameters
    ----------
    path : Path
    found : sequence of (Plan, mapping of str to Recording)
        Setups, and what is recorded of each.
    rows : list of dict
        Figures of each.
    png : Path or None
    """
    runs = [Run(plan, records, milled_contour(plan, records), seen_deviation(plan, records)) for plan, records in found]
    with styled():
        name = f"The toroid in steel, setup {', '.join(plan.setup for plan, _ in found)}"
        report = Report(name, str(path.resolve()), tuple(_facts(rows)), tuple(_sections(path, rows, runs)))
        report.write(path / PAGE)
        if png is not None:
            report.png(png)


def table_rows(rows: list[dict[str, Any]]) -> list[tuple[str, ...]]:
    """Return the figures of setups as text under `HEAD`."""
    return [tuple(_row(row)) for row in rows]


def _row(row: dict[str, Any]) -> Iterator[str]:
    yield row["setup"]
    for key in ("circle_mae", "circle_std", "circle_max", "surface_std", "roughness"):
        if key in row:
            yield f"{1e6 * row[key]:.2f}"
        else:
            seen = row.get("seen", {})
            yield f"{1e6 * seen[key]:.1f} seen" if key in seen else "-"
    yield f"{1e3 * row['turned']:.2f}" if "turned" in row else "-"
    if "travel" in row:
        most = max(max(-low, high) for low, high in row["travel"].values())
        yield f"{1e6 * most:.0f} of {1e6 * row['travel_limit']:.0f}"
        yield f"{row['seconds_at_end']:.2f}"
    else:
        yield from ("-", "-")
    yield row["fault"] or "-"


def _facts(rows: list[dict[str, Any]]) -> Iterator[Fact]:
    for row in rows:
        if "seen" in row and "circle_mae" not in row:
            yield Fact(f"MAE of the circle as it was seen, {row['setup']}", f"{1e6 * row['seen']['circle_mae']:.1f} µm")
        if "circle_mae" in row:
            yield Fact(f"MAE of the circle, {row['setup']}", f"{1e6 * row['circle_mae']:.1f} µm")
        if "travel" in row:
            yield Fact(f"At an end of the travel, {row['setup']}", f"{row['seconds_at_end']:.2f} s")
        yield Fact(f"Faults, {row['setup']}", row["fault"] or "none", not row["fault"])


def _sections(path: Path, rows: list[dict[str, Any]], runs: list[Run]) -> Iterator[Section]:
    setups = "; ".join(f"{row['setup']}: {row['what']}" for row in rows)
    yield Section(
        "Accuracy",
        f"Lengths in µm; seen: by tracker and stage, not measured on the piece.  {setups}.",
        tables=(Table(HEAD, tuple(table_rows(rows))),),
    )
    if any(run.milled is not None for run in runs):
        yield Section("Contour", plots=(polar_plot(runs), deviation_plot(runs)))
        yield Section("Surface", plots=(surface_plot(runs),))
    elif seen := [run for run in runs if run.seen is not None]:
        words = "Live, what was cut is measured afterwards; this is what tracker and stage have seen while it was."
        yield Section("Path", words, plots=(seen_plot(seen),))
    with_stage = [run for run in runs if run.plan.has_stage]
    if with_stage:
        yield Section("Travel", plots=(travel_plot(with_stage),))
    yield Section("Events", tables=(event_table(read_events(path), event_text),))
