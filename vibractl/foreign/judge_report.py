"""The page of one judged recording: its spectrum against the limit, and its spectrogram."""

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS
from rigkit.report import Fact, Plot, Report, Section
from vibractl.decibels import FAINT, decibels
from vibractl.figures.lines import BOUND, largest_by_span
from vibractl.figures.spectrogram import COLUMNS, ROW, TOP, magnitudes
from vibractl.foreign.judged import Verdict
from vibractl.judging import Judging

FLOOR = -100.0
"""dB, lower end of the scale."""


def judge_report(found: Verdict, made: Judging, source: str) -> Report:
    """Return the page of a verdict.

    Parameters
    ----------
    found : Verdict
    made : Judging
    source : str
        Name of the recording.
    """
    marks = found.marks
    facts = [Fact(f"Objective, {made.config.quality.objective:g} dB", marks.reason, marks.met)]
    for number, side in enumerate(marks.outputs):
        facts.append(Fact(f"Tracking error of response {side + 1}", f"{marks.error_db[number]:.1f} dB re reference"))
        facts.append(Fact(f"IAE of response {side + 1}", f"{marks.iae[number]:.3g} m/s^2"))
    begun = found.found.delay / made.shot.rate
    facts.append(Fact("Reference begins", f"{begun:.4f} s, correlation {found.found.likeness.min():.4f}"))
    return Report(f"{made.config.reference.signal} in {source}", source, tuple(facts), (_section(found, made),))


def _section(found: Verdict, made: Judging) -> Section:
    return Section("Spectrum and spectrogram", plots=(_plot(found, made),))


def _plot(found: Verdict, made: Judging) -> Plot:
    judge, quality = found.judge, made.config.quality
    sides = len(found.marks.outputs)
    figure = Figure(figsize=(8.5, 0.7 + 2.7 * sides))
    grid = figure.subplots(sides, 2, sharex="col", squeeze=False, width_ratios=(3, 2))
    response = judge.place.reference - found.error
    rate = made.shot.rate / made.config.learning.decimation
    time, size = magnitudes(response, rate, COLUMNS, ROW)
    lines = np.abs(judge.lines(found.error)) / judge.reference_level
    for side, (axes, image) in enumerate(grid):
        frequency, level = largest_by_span(judge.frequency[judge.judged], lines[judge.judged, side])
        axes.plot(frequency, decibels(level), linewidth=0.8, color=COLOURS[0], label="error")
        if found.silence is not None:
            quiet = found.silence[judge.judged, side] / judge.reference_level[side]
            place, quiet = largest_by_span(judge.frequency[judge.judged], quiet)
            axes.plot(place, decibels(quiet), linewidth=0.8, color="0.6", label="in silence", zorder=1)
        axes.axhline(quality.objective, **BOUND, label=f"objective, {quality.objective:g} dB")
        worst = found.marks.worst_line_hz[side], found.marks.worst_line_db[side] + quality.objective
        axes.plot(*worst, "o", markersize=9, markerfacecolor="none", markeredgecolor=COLOURS[6])
        axes.set_title(f"Response {found.marks.outputs[side] + 1}: worst {worst[1]:.1f} dB at {worst[0]:.1f} Hz")
        axes.set_ylabel("error re reference, dB")
        axes.set_ylim(bottom=max(FLOOR, axes.get_ylim()[0]))
        loudest = max(float(size[:, :, side].max()), FAINT)
        shown = image.imshow(
            decibels(size[:, :, side] / loudest), extent=(time[0], time[-1], 0.0, TOP), vmin=quality.objective,
            vmax=0.0, aspect="auto", origin="lower", interpolation="nearest",
        )  # fmt: skip
        image.grid(visible=False)
        image.set_ylabel("frequency, Hz")
    grid[0, 0].legend(loc="lower right", fontsize="small")
    grid[-1, 0].set_xlabel("frequency, Hz")
    grid[-1, 1].set_xlabel("time, s")
    figure.colorbar(shown, ax=grid[:, 1], extend="min", label="level re its largest, dB", pad=0.02, aspect=30)
    return Plot(
        figure,
        f"Left: what is judged, the error on every bin from {judge.frequency[judge.judged][0]:g} to "
        f"{judge.frequency[judge.judged][-1]:g} Hz; ring: the worst bin. Right: the response while the reference "
        "lasts.",
    )
