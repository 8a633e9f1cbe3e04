"""A pocket milled by a planner: it chooses a strip, is told how long that took, and chooses again."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Costs, Cut, Standing, after, costs, cutting, is_lifted, moving, place, untouched

SAME = 1e-9
"""Of a rate: closer ones are the same."""


@dataclass(frozen=True)
class Milled:
    """A finished segment.

    Parameters
    ----------
    standing : Standing
        Before it.
    cut : Cut
    name : str
        Its type.
    row, col : int, cells
        Where the footprint started.
    is_lifted : bool
        Whether the tool was lifted to get there.
    moved, duration : float, s
        To get there; of the milling.
    force_deviation : float, N
        Standard deviation of the force in the segment; NaN where it was not measured.
    """

    standing: Standing
    cut: Cut
    name: str
    row: int
    col: int
    is_lifted: bool
    moved: float
    duration: float
    force_deviation: float = math.nan

    def leaves(self) -> Standing:
        """Return the state after it."""
        return after(self.cut, self.standing)

    @property
    def in_path(self) -> list[str | int]:
        """Type, row, column and feed, as a path has them."""
        return [self.name, self.row, self.col, self.cut.feed]


class Planner(Protocol):
    """What mills a pocket strip by strip."""

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next."""

    def learn(self, milled: Milled) -> None:
        """Take notice of a finished segment."""


def mill(pocket: Pocket, planner: Planner, measured: Callable[[Milled], Milled] | None = None) -> list[Milled]:
    """Mill a whole pocket, and let the planner know after each segment.

    Parameters
    ----------
    pocket : Pocket
        Each segment takes as long as is really paid for it,
    planner : Planner
    measured : callable, optional
        or as long as this makes of that: it gets the segment and returns it with what is measured.

    Returns
    -------
    list of Milled
    """
    paid = costs(pocket.paid())
    standing, segments = untouched(pocket), []
    while not standing.is_done:
        cut = planner.choose(standing)
        segment = finished(cut, standing, paid)
        segments.append(segment if measured is None else measured(segment))
        planner.learn(segments[-1])
        standing = segments[-1].leaves()
    return segments


def finished(cut: Cut, standing: Standing, paid: Costs) -> Milled:
    """Return the segment that comes of a strip at the costs `paid`."""
    return Milled(
        standing,
        cut,
        cut.name(int(paid.rate.shape[1])),
        *place(cut, standing, paid),
        is_lifted(cut, standing),
        moving(cut, standing, paid),
        cutting(cut, standing, paid),
    )


def learned(belief: Costs, milled: Milled) -> Costs:
    """Return costs in which a strip, from its side, has the rate just met; `belief` itself where it had that one.

    Source
    ------
    Sörnmo 2015, sec. 8.3: "the new duration of a milling segment is known after the segment has been performed once,
    i.e., old durations for the segment are not taken into account".
    """
    way, k = milled.cut
    expected = cutting(milled.cut, milled.standing, belief)
    excess = milled.duration - expected
    if abs(excess) <= SAME * expected:
        return belief
    rate = belief.rate.copy()
    rate[way, k - 1] *= (milled.duration - belief.begin) / (expected - belief.begin)
    return belief._replace(rate=rate)


def total(segments: list[Milled]) -> float:
    """Return how long segments took, with the moves between them, s."""
    return sum(each.moved + each.duration for each in segments)
