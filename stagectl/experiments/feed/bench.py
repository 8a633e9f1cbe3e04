"""Where a pocket is milled: in the cell that is simulated here; `wired` has the robot behind its wires."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol

from rigkit.experiment.part import Part
from stagectl.experiments.feed.feed_graph import FeedGraph
from stagectl.experiments.feed.plan import FeedPlan
from stagectl.experiments.feed.pocket_part import pocket_part
from stagectl.experiments.feed.surroundings import simulated
from stagectl.link.tell import Tell
from stagectl.planning.milling import Planner

Stopped = Callable[[], bool]


class Bench(Protocol):
    """What pockets are milled on, one after another."""

    def part(self, plan: FeedPlan, planner: Planner, tell: Tell, stopped: Stopped) -> AbstractContextManager[Part]:
        """Give a pocket to be milled, its devices open.

        Parameters
        ----------
        plan : FeedPlan
        planner : Planner
        tell : callable(event, fields)
            Told of faults.
        stopped : callable() -> bool
            Asked while the devices are got ready.
        """

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Leave the machine, after the last pocket."""


class SimulatedBench:
    """The simulated cell: each pocket in a piece of its own."""

    @contextmanager
    def part(self, plan: FeedPlan, planner: Planner, tell: Tell, stopped: Stopped) -> Iterator[Part]:  # noqa: ARG002
        """Give a pocket to be milled."""
        yield pocket_part(FeedGraph(plan, lambda: planner, tell, simulated))

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Leave nothing."""
