"""The doctor's findings as a page: every verdict, and the figures behind them."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import styled
from rigkit.provenance import now, software
from rigkit.report import Fact, Plot, Report, Section, Table
from rigkit.verdict import Verdict, advice
from vibractl.decibels import FAINT, decibels
from vibractl.doctor.examination import Examination
from vibractl.doctor.opinion import WANTED
from vibractl.doctor.silence import line_density
from vibractl.proof import SLIP


def write_report(path: Path, found: Examination) -> None:
    """Write the page, whole or not at all.

    Parameters
    ----------
    path : Path
        In a folder that exists.
    found : Examination
    """
    with styled():
        facts = tuple(_fact(each) for each in found.verdicts)
        title = f"{found.config.rig.name}: verdicts of the doctor"
        Report(title, f"{now()}, {software()}", facts, tuple(_sections(found))).write(path)


def _fact(each: Verdict) -> Fact:
    figure = f"{round(each.value, 3) + 0.0:g} {each.unit}".removesuffix(" 1") if math.isfinite(each.value) else ""
    said = {"pass": figure or "in order", "warn": f"{figure} (warning)".strip(), "fail": figure}[each.grade]
    return Fact(each.check.capitalize(), said, {"pass": True, "warn": None, "fail": False}[each.grade])


def _sections(found: Examination) -> Iterator[Section]:
    rows = tuple((each.check, each.grade, each.measured, each.limit) for each in found.verdicts)
    advised = "\n\n".join(f"{line[0].upper()}{line[1:]}." for line in advice(found.verdicts))
    yield Section("Verdicts", advised, tables=(Table(("check", "verdict", "measured", "wanted"), rows),))
    if found.hum is not None:
        yield Section("Noise and hum", plots=(_noise_plot(found),))
    if found.clock is not None:
        yield Section("Clock", plots=(_clock_plot(found),))
    if found.answers is not None:
        yield Section("Channels", plots=(_answers_plot(found),))


def _noise_plot(found: Examination) -> Plot:
    assert found.hum is not None
    quality, level = found.config.quality, found.level
    frequency, density = line_density(found.silence, found.config.audio.rate)
    shown = (frequency >= found.config.learning.band[0]) & (frequency <= quality.judged_to)
    lines = decibels(np.maximum(np.sqrt(density[shown] * level.seconds) / level.line, FAINT))
    figure = Figure()
    axes = figure.subplots()
    for side, each in enumerate(lines.T, 1):
        axes.plot(frequency[shown], each, linewidth=0.8, label=f"noise, response {side}")
    axes.plot(found.hum.frequency, found.hum.level, "kx", markersize=4, label=f"harmonics of {found.hum.mains:g} Hz")
    axes.plot(
        [quality.above, quality.judged_to], [quality.objective + WANTED] * 2, "k--", linewidth=1.0, label="wanted"
    )
    axes.set(xlabel="frequency, Hz", ylabel="bin of a shot re reference, dB")
    axes.legend(ncols=2)
    return Plot(figure, "Recorded without a drive, as bins of a shot; crosses: the mains, of the louder accelerometer.")


def _clock_plot(found: Examination) -> Plot:
    assert found.clock is not None
    figure = Figure()
    axes = figure.subplots()
    axes.plot(found.clock.time, found.clock.delay, ".-")
    reach = max(2 * SLIP, 1.2 * float(np.nanmax(np.abs(found.clock.delay), initial=0.0)))
    axes.set(xlabel="time, s", ylabel="delay less the first, samples", ylim=(-reach, reach))
    return Plot(figure, "Delay over the loopback cable: a slope means two clocks, a step means lost samples.")


def _answers_plot(found: Examination) -> Plot:
    assert found.answers is not None
    figure = Figure()
    axes = figure.subplots()
    for response, coil in np.ndindex(*found.answers.response.shape[1:]):
        size = decibels(np.maximum(np.abs(found.answers.response[:, response, coil]), FAINT))
        style = "-" if response == coil else ":"
        axes.plot(found.answers.frequency, size, style, label=f"response {response + 1}, coil {coil + 1}")
    axes.set(xlabel="frequency, Hz", ylabel="dB re 1 m/s² per V")
    axes.legend()
    return Plot(figure, "Responses to a sweep on one coil at a time; solid: a coil's own accelerometer.")
