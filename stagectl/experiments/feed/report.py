"""The report of force-controlled milling: forces, estimates, feeds, the path, and what each type of strip took."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rigkit.experiment.kept import early_facts
from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from rigkit.run_folder import read_events
from stagectl.experiments.feed.figures import CELL, control_plot, time_plot
from stagectl.experiments.feed.measures import as_milled
from stagectl.experiments.feed.noticed import notice_rows, noticed
from stagectl.experiments.feed.plan import CONTROLS
from stagectl.experiments.feed.pocketed import Kept
from stagectl.planning.figures import path_plot

PAGE = "report.html"
HEAD = (
    "pocket", "time, s", "milling, s", "segments", "force, N", "its deviation, N", "largest, N", "held because",
)  # fmt: skip
TYPE_HEAD = (
    "type", "segments", "duration, s", "feed, mm/s", "lowest feed, mm/s", "force, N", "its deviation, N",
)  # fmt: skip

NOTICE_HEAD = "time, s", "segment", "noticed"


def write_report(path: Path, task: str, pockets: Sequence[Kept], found: Mapping[str, Any], png: Path | None) -> None:
    """Write `report.html` into a run's folder.

    Parameters
    ----------
    path : Path
    task : str
    pockets : sequence of Kept
    found : mapping
        The run's figures.
    png : Path or None
        Folder for the figures as PNG files as well.
    """
    with styled():
        facts = (*_facts(found), *early_facts(found))
        sections = tuple(_sections(path, found, pockets))
        title = f"Milling with {pockets[0].plan.cell.force.force:g} N: {task}"
        report = Report(title, str(path.resolve()), facts, sections)
        report.write(path / PAGE)
        if png is not None:
            report.png(png)


def pocket_rows(rows: list[dict[str, Any]]) -> list[tuple[str, ...]]:
    """Return the figures of pockets as text under `HEAD`."""
    return [
        (
            row["name"], f"{row['seconds']:.2f}", f"{row['milling']:.2f}", f"{row['segments']}",
            _text(row["force_mean"]), _text(row["force_deviation"]), f"{row['force_peak']:.1f}", row["fault"] or "-",
        )
        for row in rows
    ]  # fmt: skip


def type_rows(row: dict[str, Any]) -> list[tuple[str, ...]]:
    """Return the figures of a pocket's types as text under `TYPE_HEAD`."""
    return [
        (
            name, f"{each['segments']}", f"{each['duration']:.2f}", _text(each["feed"], 1e3),
            _text(each["slowest_feed"], 1e3), _text(each["force_mean"]), _text(each["force_deviation"]),
        )
        for name, each in row["types"].items()
    ]  # fmt: skip


def _text(value: float | None, scale: float = 1.0) -> str:
    return "-" if value is None else f"{scale * value:.2f}"


def _facts(found: Mapping[str, Any]) -> Iterator[Fact]:
    for row in found["pockets"]:
        yield Fact(row["name"], f"{row['seconds']:.1f} s")
    if "saved" in found:
        yield Fact("Saved beside position control", f"{100 * found['saved']:.1f} %")
    faults = "; ".join(row["fault"] for row in found["pockets"] if row["fault"])
    yield Fact("Faults", faults or "none", not faults)


def _sections(path: Path, found: Mapping[str, Any], pockets: Sequence[Kept]) -> Iterator[Section]:
    rows = found["pockets"]
    shown = pockets if len(pockets) <= 3 else [pockets[0], *pockets[-2:]]
    yield Section("Pockets", plots=(time_plot(rows),), tables=(Table(HEAD, tuple(pocket_rows(rows))),))
    for each in shown:
        force = each.plan.cell.force.force
        yield Section(
            f"{each.plan.control.capitalize()} control, piece {each.plan.piece}",
            f"{CONTROLS[each.plan.control].capitalize()}.",
            plots=(control_plot(each.done.recording, force, CELL),),
            tables=_noticed(each),
        )
    milled = [as_milled(each.done) for each in pockets if each.plan.feeds is None and each.done.segments]
    if milled:
        yield Section("Path", plots=(path_plot(milled, pockets[0].plan.pocket),))
    for row in rows:
        if row["types"]:
            yield Section(f"Types of {row['name']}", tables=(Table(TYPE_HEAD, tuple(type_rows(row))),))
    events = tuple((each["time"][:19].replace("T", " "), each["event"], _said(each)) for each in read_events(path))
    yield Section("Events", tables=(Table(("time, UTC", "event", "particulars"), events),))


def _noticed(pocket: Kept) -> tuple[Table, ...]:
    """Return a table of what force control has noticed, where there is anything."""
    found = noticed(pocket.done.recording)
    return (Table(NOTICE_HEAD, notice_rows(found)),) if found else ()


def _said(event: dict[str, Any]) -> str:
    if event["event"] == "milled":
        return f"{event['name']}, {len(event['path'])} segments{': ' if event['reason'] else ''}{event['reason']}"
    return ", ".join(f"{key} {value}" for key, value in event.items() if key not in ("time", "event"))
