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
from stagectl.planning.beside import PATIENCE
from stagectl.planning.milling import Planner

Stopped = Callable[[], bool]


class Bench(Protocol):
    """What pockets are milled on, one after another.

    Attributes
    ----------
    patience : float, s, or None
        For which a tick waits for the planner's choice: as of `PlannerBeside`.
    """

    patience: float | None

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
    """The simulated cell: each pocket in a piece of its own.

    Parameters
    ----------
    is_paced : bool
        Whether it runs in real time: then it does not wait for the planner.
    """

    def __init__(self, is_paced: bool = False) -> None:
        self.patience = PATIENCE if is_paced else None

    @contextmanager
    def part(self, plan: FeedPlan, planner: Planner, tell: Tell, stopped: Stopped) -> Iterator[Part]:  # noqa: ARG002
        """Give a pocket to be milled."""
        yield pocket_part(FeedGraph(plan, lambda: planner, tell, simulated))

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Leave nothing."""
