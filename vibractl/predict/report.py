"""A prediction as tables and as a page with figures."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS, styled
from rigkit.provenance import now, software
from rigkit.report import Fact, Plot, Report, Section, Table
from vibractl.figures.lines import BOUND, legend_above
from vibractl.loudness import QUANTITIES
from vibractl.predict.lines import MEANINGS, REASONS
from vibractl.predict.prediction import Prediction

MOST_BANDS = 30
"""Rows of uncertified lines, the largest bounds first."""
TALLEST = 3.0
"""Largest bound that is drawn in full."""
_MARKS = ".x+^v*"


def shots_text(found: Prediction) -> str:
    """Say in one line when the objective will be met."""
    shots = found.shots
    middle, low, high = (_shot(shots.quantile(part), shots.shots) for part in (0.5, 0.1, 0.9))
    met = int(np.isfinite(shots.met).sum())
    return f"met from shot {middle} on (median; 10 to 90 %: {low} to {high}; {met} of {len(shots.met)} simulated runs)"


def drive_table(found: Prediction) -> Table:
    """Return a row for each coil and limit: drives needed, their range, first and learned ones, and the room left."""
    limits, drives = found.made.config.limits, found.drives
    room, rows = drives.headroom(limits), []
    for coil, quantity in np.ndindex(room.shape):
        name, unit = QUANTITIES[quantity]
        each = drives.needed, drives.low, drives.high, drives.first, drives.learned
        needed, low, high, first, last = (f"{sizes[coil, quantity]:.4g}" for sizes in each)
        limit, left = f"{getattr(limits, name):g}", _room(float(room[coil, quantity]))
        rows.append((f"coil {coil + 1}, {name}, {unit}", needed, f"{low} to {high}", first, last, limit, left))
    return Table(("drive", "G⁺ R", "10 to 90 %", "first", "learned, 90 %", "limit", "room, dB"), tuple(rows))


def reason_table(found: Prediction) -> Table:
    """Return how many lines are not certified for which reason, and between which frequencies."""
    rows = []
    for reason in REASONS:
        at = found.lines.frequency[found.lines.reason == reason]
        if len(at):
            rows.append((reason, f"{len(at)}", f"{at.min():.1f} to {at.max():.1f}", MEANINGS[reason]))
    return Table(("not certified", "lines", "between, Hz", "why"), tuple(rows))


def write_report(path: Path, found: Prediction) -> None:
    """Write the page, whole or not at all.

    Parameters
    ----------
    path : Path
        In a folder that exists.
    found : Prediction
    """
    with styled():
        config = found.made.config
        title = f"{config.rig.name}: {config.reference.signal}, before it is emitted"
        Report(title, f"{now()}, {software()}", tuple(_facts(found)), tuple(_sections(found))).write(path)


def _facts(found: Prediction) -> Iterator[Fact]:
    shots, lines = found.shots, found.lines
    yield Fact("Law", found.made.config.learning.law)
    yield Fact("Objective met from shot", _shot(shots.quantile(0.5), shots.shots), math.isfinite(shots.quantile(0.5)))
    ends = " to ".join(_shot(shots.quantile(part), shots.shots) for part in (0.1, 0.9))
    yield Fact("10 to 90 % of simulated runs", ends)
    room = found.drives.headroom(found.made.config.limits)
    yield Fact("Least head-room", f"{room.min():.1f} dB", found.within_limits)
    yield Fact("Learned bins certified to converge", f"{lines.certified.sum()} of {lines.learned.sum()}")


def _sections(found: Prediction) -> Iterator[Section]:
    text = "" if not found.drives.violation else f"The guard would not let it out: {found.drives.violation}."
    yield Section("Drives", text, tables=(drive_table(found),))
    bands = sorted(found.lines.ranges(), key=lambda each: -each[3])[:MOST_BANDS]
    rows = tuple((f"{low:.1f} to {high:.1f}", reason, f"{bound:.3g}") for low, high, reason, bound in bands)
    tables = (reason_table(found), Table(("worst bands, Hz", "reason", "bound"), rows))
    yield Section("Convergence", plots=(_certificate_plot(found),), tables=tables)
    yield Section("Shots", shots_text(found).capitalize() + ".", plots=(_shots_plot(found),))


def _certificate_plot(found: Prediction) -> Plot:
    figure, lines = Figure(), found.lines
    axes = figure.subplots()
    shown = np.minimum(lines.bound, TALLEST)
    axes.plot(lines.frequency[lines.certified], shown[lines.certified], ".", markersize=2, label="certified")
    for number, reason in enumerate(REASONS):
        at = (lines.reason == reason) & lines.learned
        if at.any():
            colour, mark = COLOURS[(number + 1) % len(COLOURS)], _MARKS[number % len(_MARKS)]
            axes.plot(lines.frequency[at], shown[at], mark, markersize=3, color=colour, label=reason)
    axes.axhline(1.0, **BOUND)
    axes.set(xlabel="frequency, Hz", ylabel="bound on contraction", ylim=(0.0, 1.05 * max(1.05, float(shown.max()))))
    axes.set_xlim(*lines.frequency[lines.learned][[0, -1]])
    legend_above(axes)
    return Plot(
        figure,
        "Part of the error that the first update leaves, at most, with two standard deviations of G; bounds "
        f"above {TALLEST:g} are drawn there. Not certified does not mean that it diverges.",
    )


def _shots_plot(found: Prediction) -> Plot:
    figure, worst = Figure(), found.shots.worst
    axes = figure.subplots()
    axes.plot(np.arange(len(worst)), worst, color=COLOURS[4], linewidth=0.8)
    axes.axhline(0.0, **BOUND)
    low, high = np.nanmin(worst), np.nanmax(worst)
    axes.set(xlabel="shot", ylabel="worst bin over the limit, dB", ylim=(max(low, -40) - 3, min(high, 60) + 3))
    return Plot(
        figure, "The worst bin of every simulated run, each on another vibrator that the model does not rule out."
    )


def _room(level: float) -> str:
    return f"{level:.1f}" if math.isfinite(level) else "–"


def _shot(number: float, most: int) -> str:
    return f"{number:.0f}" if math.isfinite(number) else f"beyond {most}"
