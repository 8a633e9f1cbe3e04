"""What recordings of anybody's gave, on a page and in figures."""

from dataclasses import asdict
from typing import Any

import numpy as np

from calibration.from_recordings import Found
from calibration.from_verdict import VERDICT_HEAD, verdicts
from calibration.recorded_pair import Prepared
from calibration.sweep_report import bode_figure, certainty_figure
from calibration.sweep_summary import WORST_HEAD, relative_deviation, worst_rows
from rigkit.figure_style import styled
from rigkit.report import Fact, Plot, Report, Section, Table
from vibractl.config import RigConfig

RECORD_HEAD = (
    "record", "s", "read as", "recorder's clock, ppm", "drives, V rms", "responses, m/s² rms", "noise of a bin, dB",
    "even distortion", "odd distortion",
)  # fmt: skip
GAP_HEAD = ("no value, Hz", "why")


def record_rows(found: Found) -> list[tuple[str, ...]]:
    """Return a row for each record."""
    return [
        (
            each.name,
            f"{each.seconds:.1f}",
            _kind(each),
            _clock(each),
            *(", ".join(f"{level:.3g}" for level in side) for side in each.levels),
            *(_levels(each, name) for name in ("noise", "even", "odd")),
        )
        for each in found.records
    ]


def gap_rows(found: Found) -> list[tuple[str, str]]:
    """Return a row for each band without values."""
    return [(f"{gap.low:g} to {gap.high:g}", gap.reason) for gap in found.gaps]


def notes(found: Found) -> list[str]:
    """Return, in sentences, what a person should know of times and clocks."""
    said = []
    if found.late and found.is_late:
        said.append(f"responses begin {1e3 * found.late:.2f} ms after drives; that is in the model")
    elif found.late:
        said.append(
            f"responses began {found.late:.3f} s after drives; that is taken out: delays in the model are not the rig's"
        )
    if blind := [each.name for each in found.records if not np.isfinite(each.drift.error)]:
        said.append(
            f"{', '.join(blind)}: whether player and recorder have one clock is not shown; if they are two devices, "
            "play every frequency twice in one recording, some time apart"
        )
    return said


def from_report(found: Found, rig: RigConfig) -> Report:
    """Put the report together."""
    judged = verdicts(found)
    facts = (
        Fact("lines", f"{len(found.matrix.frequency)} of {len(found.wanted)}"),
        Fact("recorded", f"{found.seconds:.1f} s in {len(found.records)} records"),
        Fact("median relative deviation", f"{100 * np.median(relative_deviation(found.matrix)):.2g} %"),
        *(Fact(f"{each.low:g} to {each.high:g} Hz", each.word, each.word != "no value") for each in judged),
    )
    text = "Two standard deviations are shaded. Noise is in them, and what the responses do that is not linear."
    about = "\n\n".join(f"{note[0].upper()}{note[1:]}." for note in notes(found))
    with styled():
        sections = [
            Section("Bands", "", (), (Table(VERDICT_HEAD, tuple(each.row for each in judged)),)),
            Section(
                "Transfer matrix", text, (Plot(bode_figure(found.matrix), "Magnitude and phase, output from input."),)
            ),
            Section(
                "Certainty",
                "",
                (Plot(certainty_figure(found.matrix), "Relative standard deviation, and coherence of each output."),),
                (Table(WORST_HEAD, tuple(worst_rows(found.matrix))),),
            ),
            Section("Records", about, (), (Table(RECORD_HEAD, tuple(record_rows(found))),)),
        ]
        if found.gaps:
            sections.append(Section("Without values", "", (), (Table(GAP_HEAD, tuple(gap_rows(found))),)))
    date = found.matrix.provenance["date"]
    return Report("Vibrator from recordings", f"{rig.rig.name}, {date}", facts, tuple(sections))


def from_figures(found: Found) -> dict[str, Any]:
    """Return what other programs read of it."""
    relative = relative_deviation(found.matrix)
    return {
        "lines": len(found.matrix.frequency),
        "wanted": len(found.wanted),
        "median_relative_deviation": float(np.median(relative)),
        "worst_relative_deviation": float(relative.max()),
        "seconds": found.seconds,
        "late_s": found.late,
        "late_is_in_model": found.is_late,
        "bands": [{key: value for key, value in asdict(each).items() if value == value} for each in verdicts(found)],
        "gaps": [{"from": gap.low, "to": gap.high, "reason": gap.reason} for gap in found.gaps],
        "records": [_record_figures(each) for each in found.records],
    }


def _record_figures(each: Prepared) -> dict[str, Any]:
    shown = bool(np.isfinite(each.drift.error))
    figures: dict[str, Any] = {
        "name": each.name,
        "seconds": each.seconds,
        "blocks": each.blocks,
        "clock_ppm": 1e6 * each.drift.value if shown else None,
        "clock_error_ppm": 1e6 * each.drift.error if shown else None,
        "clock_corrected": each.is_corrected,
        "drives_rms": each.levels[0],
        "responses_rms": each.levels[1],
    }
    told = each.multisine
    if told is not None:
        figures["multisine"] = {
            "period": told.period,
            "averages": told.averages,
            "multisines": told.multisines,
            **{f"{name}_db": _finite(getattr(told, name)) for name in ("noise", "even", "odd")},
        }
    return figures


def _finite(levels: np.ndarray) -> list[float] | None:
    return [float(level) for level in levels] if np.isfinite(levels).all() else None


def _kind(each: Prepared) -> str:
    told = each.multisine
    if told is None:
        return f"sweeps or noise, {each.blocks} block{'s' * (each.blocks != 1)}"
    several = f"{told.multisines} multisines" if told.multisines > 1 else "multisine"
    return f"{several} of {told.period:g} s, {told.averages} periods averaged"


def _clock(each: Prepared) -> str:
    if not np.isfinite(each.drift.error):
        return "not shown"
    taken = ", taken out" if each.is_corrected else ""
    return f"{1e6 * each.drift.value:+.3g} ± {1e6 * each.drift.error:.2g}{taken}"


def _levels(each: Prepared, name: str) -> str:
    levels = None if each.multisine is None else _finite(getattr(each.multisine, name))
    return "-" if levels is None else ", ".join(f"{level:.0f}" for level in levels)
