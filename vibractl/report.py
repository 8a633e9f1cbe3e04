"""The report of a run: what was reached, how, and with which model, on one page."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rigkit.event_table import event_table
from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from rigkit.run_folder import read_events
from vibractl.figures.drive import drive_plot, drive_spectrum_plot, headroom_table
from vibractl.figures.model import magnitude_plot, trust_plot
from vibractl.figures.progress import learning_plot, overtone_plot, phase_plot
from vibractl.figures.result import Result, read_result
from vibractl.figures.spectrogram import spectrogram_plot
from vibractl.figures.spectrum import error_plot, response_plot
from vibractl.figures.tracking import error_time_plot, tracking_plot
from vibractl.quality_table import RISE, floor_said, summary
from vibractl.reference import is_file, is_one_tone
from vibractl.setup import Setup
from vibractl.transfer_matrix import TransferMatrix

PAGE = "report.html"
SHOTS_TEXT = (
    "For each side, or hydrophone: over, level of the worst bin over the limit (negative is good), and where; "
    "IAE; error, its RMS re the reference's. For each coil: room, peak limit over peak drive. repeat: part of the "
    "response's change since the last shot that the model does not explain, re the response. align: residual of the "
    "alignment, samples."
)
_PLACES = {"accelerometers": "At the accelerometers", "far-field": "In the far field"}
_ELSEWHERE = "The same shots at these sensors; the objective need not hold here."


def run_report(path: Path, png: Path | None = None) -> dict[str, Any]:
    """Write `report.html` into a run folder, whole or not at all.

    Parameters
    ----------
    path : Path
        Run folder of at least one shot; it may belong to a run that goes on.
    png : Path, optional
        Folder for the figures as PNG files as well.

    Returns
    -------
    dict
        As `session.summary`.

    Raises
    ------
    ValueError : no shot is recorded, or the folder lacks a part.
    """
    result = read_result(path)
    figures = summary([dict(row) for row in result.rows], result.made)
    with styled():
        report = Report(
            f"{_reference_name(result)} on {result.made.config.rig.name}",
            str(path.resolve()),
            tuple(_facts(result, figures, read_events(path))),
            tuple(_sections(result, read_events(path))),
        )
        report.write(path / PAGE)
        if png is not None:
            report.png(png)
    return figures


def _reference_name(result: Result) -> str:
    reference = result.made.reference
    if is_file(reference.text):
        return f"Recording {Path(reference.text).name}, {result.made.shot.sounded / result.made.shot.rate:.3g} s,"
    kind, *numbers = reference.text.split(":")
    return f"{kind.capitalize()} of {' to '.join(numbers[:-1])} Hz, {numbers[-1]} s,"


def _facts(result: Result, figures: Mapping[str, Any], events: list[dict[str, Any]]) -> Iterator[Fact]:
    met, worst, quality = figures["objective_met_shot"], figures["worst_line_db"], result.made.config.quality
    last = result.rows[-1]
    where = " in the far field" if quality.where == "far-field" else ""
    yield Fact(
        f"Objective, {quality.objective:g} dB{where}",
        "not met" if met is None else f"met from shot {met} on",
        met is not None,
    )
    yield Fact("Worst bin of the last shot", _beside_limit(worst), worst <= 0)
    yield from _rise(result.rows, figures)
    what, size = floor_said(figures)
    if what:
        yield Fact(what.removesuffix(" by").capitalize(), size, figures["floor_db"] <= 0)
    for number, side in enumerate(result.sides):
        yield Fact(f"IAE of {result.sensor} {side}, first over last", f"{figures['iae_ratio'][number]:.3g}")
    for number, side in enumerate(result.sides):
        error = float(result.cell(last, f"error_db_{number + 1}"))
        yield Fact(f"Tracking error of {result.sensor} {side}", f"{error:.1f} dB re reference")
    if result.elsewhere is not None:
        yield _elsewhere(result.elsewhere, figures["places"])
    rooms = [float(last[f"headroom_db_{coil}"]) for coil in result.coils if last[f"headroom_db_{coil}"]]
    if rooms:
        limit = result.made.config.limits.peak
        yield Fact("Head-room of the last drive", f"{min(rooms):.1f} dB under {limit:g} V", min(rooms) >= 0)
    discarded = sum(event["event"] == "discarded" for event in events)
    yield Fact("Shots", f"{len(result.rows)}" + (f", {discarded} discarded" if discarded else ""))
    made = result.made
    if isinstance(made, Setup):
        to = f"{made.learned.sensor}s" if made.learned.is_far else "sides"
        drives = f"{len(result.coils)} to {len(made.learned.sensors)}, {made.config.learning.structure}"
        yield Fact(f"Drives to {to}", drives)
    yield Fact("Reference", made.reference.text if not is_file(made.reference.text) else "recording")
    date = result.model.provenance.get("date") if result.model else None
    yield Fact(
        "Model measured", f"{date[:16].replace('T', ' ')} UTC" if date else "not dated" if result.model else "none"
    )


def _sections(result: Result, events: list[dict[str, Any]]) -> Iterator[Section]:
    made = result.made
    note = made.note if isinstance(made, Setup) else ""
    yield Section("Spectrograms", note, plots=(spectrogram_plot(result),))
    yield Section("Spectra", plots=(response_plot(result), error_plot(result)))
    yield Section("Learning", plots=(learning_plot(result),))
    other = result.elsewhere
    if other is not None:
        figures = spectrogram_plot(other), response_plot(other), error_plot(other), learning_plot(other)
        yield Section(_PLACES[other.judge.place.name], _ELSEWHERE, plots=figures)
    yield Section("Tracking", plots=(tracking_plot(result), error_time_plot(result)))
    if is_one_tone(made.reference.text):  # else nothing says which phase its overtones would have
        yield Section("Overtones and phase", plots=(overtone_plot(result), phase_plot(result)))
    yield Section("Drives", plots=(drive_plot(result), drive_spectrum_plot(result)), tables=(headroom_table(result),))
    if isinstance(made, Setup) and result.model is not None:
        plots = magnitude_plot(result.model), trust_plot(result.model, made)
        yield Section("Model", _model_text(result.model), plots=plots)
    yield Section("Shots", SHOTS_TEXT, tables=(shot_table(result),))
    if events:
        yield Section("Events", tables=(event_table(events),))


def _rise(rows: Sequence[Mapping[str, str]], figures: Mapping[str, Any]) -> Iterator[Fact]:
    """Say how far a run that began faint has come, and how loud it was at its loudest."""
    if not any(row["verdict"] == RISE for row in rows):
        return
    full, loudest = figures["full_level_shot"], figures["loudest_line_db"]
    yield Fact(
        "Full level",
        f"not reached: {rows[-1]['reason'].split(',')[0]}" if full is None else f"from shot {full} on",
        full is not None,
    )
    yield Fact("Loudest bin of any shot", _beside_limit(loudest), loudest <= 0)


def _beside_limit(over: float) -> str:
    """Say how far a line, dB over the limit, is from it."""
    return f"{abs(over):.1f} dB {'over' if over > 0 else 'under'} the limit"


def _elsewhere(other: Result, places: Mapping[str, Any]) -> Fact:
    """Say how the objective stands where it need not hold."""
    name = other.judge.place.name
    reached = places[name]
    worst, met = reached["worst_line_db"], reached["objective_met_shot"]
    said = "not met" if met is None else f"met from shot {met} on"
    return Fact(f"{_PLACES[name]}, beside that", f"{said}; last shot {_beside_limit(worst)}")


def _model_text(model: TransferMatrix) -> str:
    told = model.provenance
    return "; ".join(f"{name}: {told[name]}" for name in ("rig", "date", "recording", "software") if name in told) + "."


def shot_table(result: Result) -> Table:
    """Return a row for each shot: the columns of `qc.csv` that a person reads."""
    columns = [("gain", "gain", "{:g}")]
    for number, side in enumerate(result.sides, start=1):
        columns += [
            (f"worst_line_db_{number}", f"over {side}, dB", "{:+.1f}"),
            (f"worst_line_hz_{number}", "at, Hz", "{:.1f}"),
            (f"iae_{number}", f"IAE {side}, {result.unit}", "{:.0f}"),
            (f"error_db_{number}", f"error {side}, dB", "{:.1f}"),
        ]
    columns += [(f"headroom_db_{coil}", f"room {coil}, dB", "{:.1f}") for coil in result.coils]
    columns += [("repeatability_db", "repeat, dB", "{:.1f}"), ("residual", "align", "{:.3f}")]
    head = ("shot", "objective", *(title for _, title, _ in columns))
    rows = []
    for row in result.rows:
        cells = [(result.cell(row, key), form) for key, _, form in columns]
        told = (form.format(float(cell)) if cell else "–" for cell, form in cells)
        rows.append((row["shot"], row["verdict"], *told))
    return Table(head, tuple(rows))
