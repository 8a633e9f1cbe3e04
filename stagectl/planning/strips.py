"""Strips off a pocket by name: what may be milled from where the tool stands, how far, and for how long."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from stagectl.planning import strip_kernel as kernel
from stagectl.planning.problem import Pocket

NO_WAY = -1
"""Of a tool that has not begun."""

_FEEDS = "EWEWSNSN"
_SIDES = "NNSSWWEE"


class Rectangle(NamedTuple):
    """What is left uncut: rows `north` ... `south` - 1, columns `west` ... `east` - 1, cells."""

    north: int
    south: int
    west: int
    east: int


class Standing(NamedTuple):
    """What is left uncut, and the way that was milled last: the whole state of a pocket."""

    uncut: Rectangle
    way: int

    @property
    def is_done(self) -> bool:
        """Whether nothing is left."""
        return self.uncut.north >= self.uncut.south or self.uncut.west >= self.uncut.east


class Cut(NamedTuple):
    """A strip of `k` rows or columns, milled one way: a side and a feed, numbered as in `strip_kernel`."""

    way: int
    k: int

    @property
    def feed(self) -> str:
        """E, W, N or S."""
        return _FEEDS[self.way]

    @property
    def side(self) -> str:
        """The side off which it is milled: N, S, W or E."""
        return _SIDES[self.way]

    def name(self, tool: int) -> str:
        """Return its type: feed, k, and the hand where it is narrower than the tool."""
        axis, across, along = self.way >> 2 & 1, self.way >> 1 & 1, self.way & 1
        hand = "du"[axis ^ across ^ along]
        return f"{self.feed}{self.k}{hand if self.k < tool else ''}"


class Costs(NamedTuple):
    """What a pocket costs, as arrays.

    Parameters
    ----------
    pocket : array of one `strip_kernel.POCKET`
        Its size, and s a segment.
    rate : array, shape (ways, tool), s per cell
        By way and k - 1.
    moves : array, shape (2, rows + 2 tool, cols + 2 tool), s
        A move without and with a lift, by rows and columns between.
    """

    pocket: np.ndarray
    rate: np.ndarray
    moves: np.ndarray

    @property
    def begin(self) -> float:
        """What every segment takes, s."""
        return float(self.pocket["begin"][0])


def costs(pocket: Pocket) -> Costs:
    """Return the costs that `pocket` states."""
    ways = 4 if pocket.feeds == "EW" else 8
    size = np.array([(pocket.rows, pocket.cols, pocket.G, pocket.closed, ways, pocket.t_acc)], kernel.POCKET)
    rate = np.empty((ways, pocket.G))
    for way in range(ways):
        for k in range(1, pocket.G + 1):
            cut = Cut(way, k)
            rate[way, k - 1] = pocket.rate[cut.name(pocket.G)] * pocket.theta.get(cut.side, 1.0)
    margin = 2 * pocket.G
    distance = np.hypot(*np.ogrid[: pocket.rows + margin, : pocket.cols + margin])
    lifted = (
        np.full(distance.shape, pocket.t_lift) if pocket.v_lift is None else pocket.t_lift + distance / pocket.v_lift
    )
    return Costs(size, rate, np.stack([pocket.step * distance, lifted]))


def untouched(pocket: Pocket) -> Standing:
    """Return the state before the first segment."""
    return Standing(Rectangle(0, pocket.rows, 0, pocket.cols), NO_WAY)


def legal(standing: Standing, cost: Costs) -> Iterator[Cut]:
    """Go through the strips that may be milled next."""
    ways, tool = cost.rate.shape
    uncut = tuple(standing.uncut)
    for way in range(ways):
        for k in range(1, tool + 1):
            if kernel.is_legal(way, k, uncut, cost.pocket):
                yield Cut(way, k)


def cutting(cut: Cut, standing: Standing, cost: Costs) -> float:
    """Return for how long a strip is milled, s, acceleration included."""
    return float(cost.begin + cost.rate[cut.way, cut.k - 1] * kernel.length(cut.way, tuple(standing.uncut)))


def is_lifted(cut: Cut, standing: Standing) -> bool:
    """Whether the tool must be lifted to where the strip starts."""
    return standing.way != NO_WAY and kernel.starts_at_corner(cut.way) != kernel.ends_at_corner(standing.way)


def moving(cut: Cut, standing: Standing, cost: Costs) -> float:
    """Return for how long the tool moves to where the strip starts, s; 0 for the first one."""
    if standing.way == NO_WAY:
        return 0.0
    row, col = kernel.start(cut.way, cut.k, tuple(standing.uncut), cost.pocket)
    at_row, at_col = kernel.stop(standing.way, tuple(standing.uncut), cost.pocket)
    return float(cost.moves[int(is_lifted(cut, standing)), abs(row - at_row), abs(col - at_col)])


def after(cut: Cut, standing: Standing) -> Standing:
    """Return the state that a strip leads to."""
    return Standing(Rectangle(*kernel.without(cut.way, cut.k, tuple(standing.uncut))), cut.way)


def place(cut: Cut, standing: Standing, cost: Costs) -> tuple[int, int]:
    """Return row and column of the footprint where the strip starts, cells."""
    row, col = kernel.start(cut.way, cut.k, tuple(standing.uncut), cost.pocket)
    return int(row), int(col)
