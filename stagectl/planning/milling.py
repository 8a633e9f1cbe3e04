"""A pocket milled by a planner: it chooses a strip, is told how long that took, and chooses again."""

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
    """

    standing: Standing
    cut: Cut
    name: str
    row: int
    col: int
    is_lifted: bool
    moved: float
    duration: float

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


def mill(pocket: Pocket, planner: Planner) -> list[Milled]:
    """Mill a whole pocket, each segment as long as is really paid for it, and let the planner know after each."""
    paid = costs(pocket.paid())
    standing, segments = untouched(pocket), []
    while not standing.is_done:
        cut = planner.choose(standing)
        segments.append(finished(cut, standing, paid))
        planner.learn(segments[-1])
        standing = after(cut, standing)
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
