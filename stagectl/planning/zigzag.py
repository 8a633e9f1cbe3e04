"""The default order: back and forth off one side, each strip as wide as it can be."""

from stagectl.planning.problem import Pocket
from stagectl.planning.strips import NO_WAY, Cut, Standing, costs, is_lifted, legal

BEGINS = 0
"""The way of the first strip: off the north side, to the east."""


class ZigzagPlanner:
    """Mills back and forth off one side, whatever that takes: what goes on while a planner has not chosen.

    Parameters
    ----------
    pocket : Pocket
    """

    def __init__(self, pocket: Pocket) -> None:
        self._costs = costs(pocket)

    def choose(self, standing: Standing) -> Cut:
        """Return the widest strip of the opposite feed off the same side, or else the widest without a lift, or any."""
        onward = BEGINS if standing.way == NO_WAY else standing.way ^ 1
        return min(
            legal(standing, self._costs),
            key=lambda cut: (cut.way != onward, is_lifted(cut, standing), -cut.k, cut.way),
        )

    def learn(self, milled: object) -> None:
        """Learn nothing."""
