"""The figures of planned pockets: the path, and how long each pocket took."""

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle as Patch
from matplotlib.ticker import MaxNLocator

from rigkit.figure_style import COLOURS, LIMIT
from rigkit.report import Plot
from stagectl.planning import strip_kernel
from stagectl.planning.milling import Milled, total
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import costs

BLUE, RED, GREEN = COLOURS[:3]
BOUND: dict[str, Any] = {**LIMIT}
"""Keywords of a line that shows a limit."""
WIDTH = 4.2
"""Inches a pocket."""


def path_plot(pockets: Sequence[Sequence[Milled]], pocket: Pocket) -> Plot:
    """Draw the paths of the first and the last pocket: start green, end red, lifts dashed."""
    shown = [0] if len(pockets) == 1 else [0, len(pockets) - 1]
    height = WIDTH * min(max(pocket.rows / pocket.cols, 0.4), 2.0)
    figure = Figure(figsize=(2 * WIDTH, height + 0.4))
    for place, number in enumerate(shown, start=1):
        panel = figure.add_subplot(1, len(shown), place, anchor="W")
        _draw(panel, pockets[number], pocket)
        panel.set_title(f"pocket {number + 1}: {total(list(pockets[number])):.2f} s")
    return Plot(figure, "The tool's centre, in cells: start green, end red, lifts dashed, walls grey. North is up.")


def time_plot(pockets: Sequence[Sequence[Milled]], optimum: float) -> Plot:
    """Draw how long each pocket took, and the optimum, s."""
    figure = Figure(figsize=(8.0, 2.8))
    panel = figure.add_subplot()
    times = [total(list(each)) for each in pockets]
    panel.plot(range(1, len(times) + 1), times, marker="o", color=BLUE, label="milled")
    panel.axhline(optimum, **BOUND, label="optimum")
    panel.set_xlabel("pocket")
    panel.set_ylabel("time, s")
    panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    panel.legend()
    return Plot(figure, "The time of each pocket, and the least time at what is really paid.")


def _draw(panel: Axes, segments: Sequence[Milled], pocket: Pocket) -> None:
    size, half = costs(pocket).pocket, pocket.G / 2.0
    edge = "#888888" if pocket.closed else "#cccccc"
    panel.add_patch(Patch((0, 0), pocket.cols, pocket.rows, facecolor="#f4f4f4", edgecolor=edge))
    last: tuple[float, float] | None = None
    for each in segments:
        row, col = strip_kernel.stop(each.cut.way, tuple(each.leaves().uncut), size)
        row, col = (row, each.col) if each.cut.feed in "NS" else (each.row, col)
        begin, end = (each.col + half, each.row + half), (col + half, row + half)
        if last is not None:
            style = "--" if each.is_lifted else "-"
            panel.plot(*zip(last, begin, strict=True), style, color=RED if each.is_lifted else BLUE, linewidth=0.9)
        panel.plot(*zip(begin, end, strict=True), "-", color=BLUE, linewidth=0.6 + each.cut.k)
        last = end
    first = segments[0]
    panel.plot(first.col + half, first.row + half, "o", color=GREEN, markersize=9)
    if last is not None:
        panel.plot(*last, "o", color="red", markersize=9)
    panel.set_xlim(-half, pocket.cols + half)
    panel.set_ylim(pocket.rows + half, -half)
    panel.set_aspect("equal")
    panel.grid(False)
