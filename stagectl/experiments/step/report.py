"""The report of steps and multisines: what each manipulator answered, and the model that is nearest to it."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from matplotlib.figure import Figure

from ctlblocks.recording import Recording
from rigkit.command import print_table
from rigkit.experiment.kept import early_facts
from rigkit.figure_style import COLOURS, styled
from rigkit.report import Fact, Plot, Report, Section, Table
from stagectl.experiments.step.response import MANIPULATORS, Response, Wanted, response

PAGE = "report.html"
HEAD = ("manipulator", "gain", "+-", "dead time, ms", "+-", "time constant, ms", "+-", "bandwidth, Hz", "noise, µm",
        "unexplained, %")  # fmt: skip
LINEAR = 0.05
"""Part of a response up to which the model is taken to describe it."""
SURE = 1.96
SHADED = "Shaded: where it is nineteen times of twenty."


def rows(figures: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return a row for each manipulator under `HEAD`."""
    return [tuple(_row(name, figures[name])) for name in MANIPULATORS if name in figures]


def _row(name: str, told: Mapping[str, Any]) -> Iterator[str]:
    yield name
    for key, scale in (("gain", 1.0), ("delay", 1e3), ("time_constant", 1e3)):
        yield f"{scale * told[key]:.4g}"
        yield f"{scale * told[f'{key}_error']:.2g}"
    yield f"{told['bandwidth']:.4g}"
    yield f"{1e6 * told['noise']:.3g}"
    yield f"{100 * told['unexplained']:.2g}"


def tell(figures: Mapping[str, Any], out: TextIO) -> None:
    """Tell a person what is read off, what the model does not describe, and the lines for the rig file."""
    print_table("responses", HEAD, rows(figures), out)
    out.writelines(f"{sentence}\n" for sentence in unlike(figures))
    out.writelines(f"{line}\n" for line in lines(figures))


def lines(figures: Mapping[str, Any]) -> list[str]:
    """Return the lines that `[midranging.pair]` of a rig file is to have, its heading first: TOML."""
    found = ["[midranging.pair]"]
    for name in (name for name in MANIPULATORS if name in figures):
        (pole,), (gain,) = figures[name]["terms"]["outputs"], figures[name]["terms"]["inputs"]
        terms = {"outputs": f"[{pole:.8g}]", "inputs": f"[{gain:.8g}]", "delay": f"{float(figures[name]['delay']):.4g}"}
        found += [f"{MANIPULATORS[name]}_{key} = {value}" for key, value in terms.items()]
    return found


def write_report(
    path: Path, record: Recording, wanted: Wanted, figures: Mapping[str, Any], png: Path | None = None
) -> None:
    """Write `report.html` into a folder, and the figures as PNG files into another one where that is given."""
    found = {name: response(record, name, wanted) for name in wanted.manipulators}
    with styled():
        plots = tuple(_plot(name, each) for name, each in found.items() if each is not None)
        facts = [Fact(f"Dead time, {row[0]}", f"{row[3]} ms") for row in rows(figures)]
        facts += [Fact(f"Unexplained, {name}", f"{100 * part:.2g} %", part <= LINEAR) for name, part in _left(figures)]
        about = (
            "The model is of first order with dead time, fitted to all repetitions; +- is one standard error, by "
            "leaving out each repetition in turn; it does not cover the error of the model structure."
        )
        section = Section("Responses", about, plots, (Table(HEAD, tuple(rows(figures))), _terms(figures)))
        title = f"{wanted.kind.capitalize()} responses of {' and '.join(wanted.manipulators)}"
        report = Report(title, str(path.resolve()), (*facts, *early_facts(figures)), (section,))
        report.write(path / PAGE)
        if png is not None:
            report.png(png)


def unlike(figures: Mapping[str, Any]) -> list[str]:
    """Return a sentence for each manipulator that the model does not describe."""
    return [
        f"{name}: {100 * part:.2g} % of the response is not of first order with dead time (friction, backlash, a "
        "resonance, a limit): look at it, and try steps of another size"
        for name, part in _left(figures)
        if part > LINEAR
    ]


def _left(figures: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    for name in MANIPULATORS:
        if name in figures:
            yield name, figures[name]["unexplained"]


def _terms(figures: Mapping[str, Any]) -> Table:
    """Return what `[midranging.pair]` is to have."""
    heading, *keys = lines(figures)
    return Table((heading, "at the rate of the run; dead times in s"), tuple(tuple(key.split(" = ")) for key in keys))


def _plot(name: str, found: Response) -> Plot:
    if np.iscomplexobj(found.measured):
        return Plot(_bode(name, found), f"{name}: frequency response, measured and modelled. {SHADED}")
    figure = Figure(figsize=(7.0, 3.0), layout="constrained")
    axes = figure.subplots(1, 1, squeeze=False)[0, 0]
    band = SURE * found.spread
    axes.fill_between(found.at, found.measured - band, found.measured + band, color=COLOURS[0], alpha=0.3, linewidth=0)
    axes.plot(found.at, found.measured, color=COLOURS[0], label="measured, mean of all periods")
    axes.plot(found.at, found.modelled, color=COLOURS[1], linewidth=1.0, linestyle="--", label="model")
    axes.set(xlabel="s from the step up", ylabel=f"{name}, of the step")
    axes.legend()
    return Plot(figure, f"{name}: response to a step, measured and modelled. {SHADED}")


def _bode(name: str, found: Response) -> Figure:
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    gain, phase = figure.subplots(2, 1, sharex=True, squeeze=False)[:, 0]
    size, band = np.abs(found.measured), SURE * found.spread
    low = np.maximum(size - band, 1e-2 * size)
    gain.fill_between(found.at, low, size + band, color=COLOURS[0], alpha=0.3, linewidth=0)
    gain.loglog(found.at, size, ".", color=COLOURS[0], markersize=3, label="measured")
    gain.loglog(found.at, np.abs(found.modelled), color=COLOURS[1], linewidth=1.0, label="model")
    measured, modelled = (np.degrees(np.unwrap(np.angle(each))) for each in (found.measured, found.modelled))
    phase.semilogx(found.at, measured, ".", color=COLOURS[0], markersize=3)
    phase.semilogx(found.at, modelled, color=COLOURS[1], linewidth=1.0)
    gain.set(ylabel=f"gain, {name}")
    phase.set(xlabel="Hz", ylabel="degrees")
    gain.legend()
    return figure
