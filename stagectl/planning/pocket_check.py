"""Whether a path mills a pocket: every segment is held against the rules on the cells themselves.

The planners' own geometry (`strip_kernel`) is not used here, so that a slip in one shows in the other.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stagectl.planning.problem import SIDES, Pocket, shortened


@dataclass(frozen=True)
class Verdict:
    """What is to be said of a path.

    Parameters
    ----------
    total : float, s
        At what is really paid, up to the fault if there is one.
    complete : bool
        Whether nothing is left uncut.
    error : str or None
        The first fault, by segment and rule; None where the path is legal.
    left : int, cells
        What is left uncut.
    """

    total: float
    complete: bool
    error: str | None
    left: int


@dataclass(frozen=True)
class _Segment:
    """A segment that obeys the rules, read as cut from `side`."""

    side: str
    feed: str
    time: float
    begins: tuple[int, int]
    ends: tuple[int, int]

    @property
    def first_corner(self) -> frozenset[str]:
        return frozenset({self.side, {"E": "W", "W": "E", "N": "S", "S": "N"}[self.feed]})

    @property
    def last_corner(self) -> frozenset[str]:
        return frozenset({self.side, self.feed})


class _Fault(Exception):
    """A rule is broken."""


def check(pocket: Pocket, path: Sequence[Sequence[Any]]) -> Verdict:
    """Mill `path` cell by cell and say whether it is legal, whether it leaves anything, and what it costs.

    Parameters
    ----------
    pocket : Pocket
    path : sequence of [type, row, col, feed]
        Row and column are of the north-west cell of the tool's footprint where the segment starts.

    Returns
    -------
    Verdict
    """
    paid = pocket.paid()
    uncut = np.ones((pocket.rows, pocket.cols), bool)
    total, before = 0.0, None
    for number, each in enumerate(path, start=1):
        try:
            readings = _mill(paid, uncut, each)
        except _Fault as fault:
            return Verdict(total, False, f"segment {number}: {fault}", int(uncut.sum()))
        # a slot that takes all that is left comes off either side: whichever costs less
        cheapest = min(readings, key=lambda reading: reading.time + _move(paid, before, reading))
        total += cheapest.time + _move(paid, before, cheapest)
        before = cheapest
    left = int(uncut.sum())
    return Verdict(total, left == 0, None, left)


def _mill(pocket: Pocket, uncut: np.ndarray, given: Sequence[Any]) -> list[_Segment]:
    """Mill one segment off `uncut`, shape (rows, cols), or raise; return it as cut from each side that it may be of."""
    name, row, col, feed = _read(pocket, given)
    flipped = feed in "NS"
    cells = uncut.T if flipped else uncut  # from here on the feed is along the second axis
    across, along = (col, row) if flipped else (row, col)
    if pocket.closed and not (0 <= row <= pocket.rows - pocket.G and 0 <= col <= pocket.cols - pocket.G):
        raise _Fault(f"the tool at row {row}, col {col} crosses a wall of {pocket.rows} x {pocket.cols} cells")
    lane = [line for line in range(across, across + pocket.G) if 0 <= line < len(cells) and cells[line].any()]
    k = int(name[1])
    if len(lane) != k:
        raise _Fault(
            f"{name} at row {row}, col {col} mills {len(lane)} {'columns' if flipped else 'rows'}, must be {k}"
        )
    low, high = np.flatnonzero(cells[lane[0]])[[0, -1]]
    forward = feed in "ES"
    wanted = low if forward else high + 1 - pocket.G
    if pocket.closed:
        wanted = min(max(wanted, 0), cells.shape[1] - pocket.G)
    if along != wanted:
        raise _Fault(f"{name} starts at {'row' if flipped else 'col'} {along}, must be {wanted}, the end of the strip")
    sides = _sides(pocket, name, cells, lane, across)
    cells[lane] = False
    length = int(high + 1 - low)
    end = max(along, high + 1 - pocket.G) if forward else min(along, low)
    ends = (int(end), across) if flipped else (across, int(end))
    return [
        _Segment(side, feed, pocket.t_acc + pocket.rate[name] * pocket.theta.get(side, 1.0) * length, (row, col), ends)
        for side in sides
    ]


def _read(pocket: Pocket, given: Sequence[Any]) -> tuple[str, int, int, str]:
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 4:
        raise _Fault(f"{shortened(given)} must be a list of type, row, col and feed")
    name, row, col, feed = given
    if name not in pocket.types:
        raise _Fault(f"type {shortened(name)} must be of {', '.join(pocket.types)}")
    if feed != name[0]:
        raise _Fault(f"feed {shortened(feed)} of a {name} must be {name[0]}")
    for what, value in (("row", row), ("col", col)):
        if not isinstance(value, int) or isinstance(value, bool):
            raise _Fault(f"{what} {shortened(value)} must be a whole number")
    return name, row, col, feed


def _sides(pocket: Pocket, name: str, cells: np.ndarray, lane: list[int], across: int) -> list[str]:
    """Return the sides off which a strip may be, of `cells` of shape (lines, along the feed)."""
    lines = np.flatnonzero(cells.any(axis=1))
    if lane[0] != lines[0] and lane[-1] != lines[-1]:
        raise _Fault(f"{name} leaves material on both sides of it, and no rectangle")
    low, high = tuple(SIDES[name[0]])
    if len(lane) == pocket.G:
        return [side for side, is_off in ((low, lane[0] == lines[0]), (high, lane[-1] == lines[-1])) if is_off]
    if lane[-1] == across + pocket.G - 1:
        side = low
    elif lane[0] == across:
        side = high
    else:
        raise _Fault(f"the strip of {name} must lie along an edge of the tool's footprint")
    right_of = {"E": "S", "S": "W", "W": "N", "N": "E"}  # the feed
    material = high if side == low else low
    hand = "d" if right_of[name[0]] == material else "u"
    if hand != name[2]:
        raise _Fault(f"{name} off the {side} side has its material on the other hand, must be {name[:2]}{hand}")
    return [side]


def _move(pocket: Pocket, before: _Segment | None, to: _Segment) -> float:
    if before is None:
        return 0.0
    distance = math.dist(before.ends, to.begins)
    if before.last_corner == to.first_corner:
        return pocket.step * distance
    return pocket.t_lift + (0.0 if pocket.v_lift is None else distance / pocket.v_lift)
