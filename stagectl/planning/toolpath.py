"""A planned path as a machine drives it: the line of the tool's centre, as G-code or as a RAPID module.

x goes east and y north from the pocket's south-west corner; z is 0 at the surface.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from stagectl.planning import strip_kernel
from stagectl.planning.cutting import Cutting
from stagectl.planning.milling import Milled
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import costs

MILLI = 1e-3


class Target(NamedTuple):
    """A straight move: where to, m, and how fast, m/s; `is_fast` where nothing is cut."""

    x: float
    y: float
    z: float
    speed: float
    is_fast: bool


def targets(segments: Sequence[Milled], pocket: Pocket, cutting: Cutting) -> Iterator[Target]:
    """Go through the moves of a path, from above its start to above its end."""
    size = costs(pocket).pocket
    at = (0.0, 0.0)
    for number, each in enumerate(segments):
        x, y = _centre(each.row, each.col, pocket, cutting)
        cells = strip_kernel.length(each.cut.way, tuple(each.standing.uncut))
        feed = cells * cutting.cell / each.duration
        if number == 0 or each.is_lifted:
            if number:
                yield Target(*at, cutting.clearance, cutting.speed, True)
            yield Target(x, y, cutting.clearance, cutting.speed, True)
        yield Target(x, y, -cutting.depth, feed, False)  # down, or sideways: into material either way
        row, col = strip_kernel.stop(each.cut.way, tuple(each.leaves().uncut), size)
        row, col = (row, each.col) if each.cut.feed in "NS" else (each.row, col)
        at = _centre(row, col, pocket, cutting)
        yield Target(*at, -cutting.depth, feed, False)
    yield Target(*at, cutting.clearance, cutting.speed, True)


def gcode(segments: Sequence[Milled], pocket: Pocket, cutting: Cutting) -> str:
    """Return a path as G-code, RS-274: mm, absolute, mm/min."""
    lines = ["; x east, y north of the pocket's south-west corner, z from the surface", "G21 G90 G94"]
    for x, y, z, speed, is_fast in targets(segments, pocket, cutting):
        place = f"X{x / MILLI:.3f} Y{y / MILLI:.3f} Z{z / MILLI:.3f}"
        lines.append(f"G0 {place}" if is_fast else f"G1 {place} F{60.0 * speed / MILLI:.1f}")
    return "\n".join([*lines, "M2", ""])


def rapid(segments: Sequence[Milled], pocket: Pocket, cutting: Cutting) -> str:
    """Return a path as a RAPID module for an ABB robot: `MillPocket` moves `tPocket` in `wPocket`, tool down."""
    lines = [
        "MODULE Pocket",
        "  ! x east, y north of the pocket's south-west corner, z from the surface, mm",
        "  PERS tooldata tPocket;",
        "  PERS wobjdata wPocket;",
        "  PROC MillPocket()",
    ]
    for x, y, z, speed, _ in targets(segments, pocket, cutting):
        place = f"[[{x / MILLI:.3f},{y / MILLI:.3f},{z / MILLI:.3f}],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]"
        lines.append(f"    MoveL {place}, [{speed / MILLI:.1f},500,5000,1000], fine, tPocket\\WObj:=wPocket;")
    return "\n".join([*lines, "  ENDPROC", "ENDMODULE", ""])


def _centre(row: int, col: int, pocket: Pocket, cutting: Cutting) -> tuple[float, float]:
    half = pocket.G / 2.0
    return (col + half) * cutting.cell, (pocket.rows - row - half) * cutting.cell
