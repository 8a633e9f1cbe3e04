"""The report of planned pockets, and what was learned of each milling type."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from stagectl.planning.figures import path_plot, time_plot
from stagectl.planning.milling import Milled, total
from stagectl.planning.problem import Pocket
from stagectl.planning.strip_kernel import length
from stagectl.planning.training_set import Memory, TrainingSet


@dataclass(frozen=True)
class Learned:
    """What segments say of a type: their number, mean and deviation of the rate, and what the file says; s per cell."""

    name: str
    count: int
    mean: float
    deviation: float
    believed: float


def learned_types(segments: Iterable[Milled], pocket: Pocket) -> list[Learned]:
    """Return what segments say of each type that was milled."""
    sets = {name: TrainingSet(Memory()) for name in pocket.types}
    for each in segments:
        cells = length(each.cut.way, tuple(each.standing.uncut))
        sets[each.name].add((each.duration - pocket.t_acc) / cells, each.force_deviation)
    return [
        Learned(name, known.count, known.mean(), known.deviation(), pocket.rate[name])
        for name, known in sets.items()
        if known.rates
    ]


def type_rows(found: Sequence[Learned]) -> list[tuple[str, ...]]:
    """Return the rows of a table of types, as text."""
    return [
        (each.name, f"{each.count}", f"{each.mean:.4g}", f"{round(each.deviation, 6):.2g}", f"{each.believed:.4g}")
        for each in found
    ]


TYPE_HEAD = ("type", "segments", "rate, s per cell", "its deviation", "in the file")


def write_report(
    path: Path, pockets: Sequence[Sequence[Milled]], pocket: Pocket, planner: str, optimum: float, known: list[Learned]
) -> None:
    """Write the page of pockets that were milled one after the other.

    Parameters
    ----------
    path : Path
        The HTML file.
    pockets : sequence of sequences of Milled
    pocket : Pocket
    planner : str
        Its name.
    optimum : float, s
    known : list of Learned
    """
    times = [total(list(each)) for each in pockets]
    facts = (
        Fact("Last pocket", f"{times[-1]:.2f} s"),
        Fact("Over the optimum", f"{100 * (times[-1] / optimum - 1):.2f} %"),
        Fact("Optimum", f"{optimum:.2f} s"),
        Fact("Lifts", f"{sum(each.is_lifted for each in pockets[-1])} of {len(pockets[-1])} segments"),
    )
    rows = tuple(
        (f"{number}", f"{time:.2f}", f"{100 * (time / optimum - 1):.2f}", f"{len(each)}")
        for number, (time, each) in enumerate(zip(times, pockets, strict=True), start=1)
    )
    with styled():
        sections = (
            Section("Path", plots=(path_plot(pockets, pocket),)),
            Section(
                "Pockets",
                plots=(time_plot(pockets, optimum),),
                tables=(Table(("pocket", "time, s", "over the optimum, %", "segments"), rows),),
            ),
            Section("Milling types", tables=(Table(TYPE_HEAD, tuple(type_rows(known))),)),
        )
        title = f"{pocket.rows} x {pocket.cols} cells by {planner}"
        Report(title, str(path.resolve()), facts, sections).write(path)
