"""Pockets milled by force control in the simulated cell, by somebody's planner: nothing is kept but their segments."""

from dataclasses import dataclass

from rigkit.experiment.runner import Conduct
from rigkit.experiment.succession import run_in_memory
from stagectl.experiments.feed.job import Job
from stagectl.experiments.feed.pockets import Pockets
from stagectl.experiments.feed.read_back import velocity_model
from stagectl.planning.milling import Milled, Planner
from stagectl.planning.problem import Pocket
from stagectl.robot.config import CellConfig


@dataclass(frozen=True)
class _Job(Job):
    """A job whose planner is there already."""

    made: Planner | None = None

    def make(self) -> Planner:
        """Return the planner."""
        assert self.made is not None
        return self.made


def simulated_pockets(
    cell: CellConfig, pocket: Pocket, planner: Planner, pockets: int, conduct: Conduct
) -> list[list[Milled]]:
    """Mill pockets by force control in the simulated cell; return the segments of each, as measured.

    Parameters
    ----------
    cell : CellConfig
    pocket : Pocket
    planner : Planner
        Goes on learning from pocket to pocket.
    pockets : int
    conduct : Conduct
        Is shown the cells that are milled.

    Raises
    ------
    ValueError : plants that do not take their options, a pocket out of reach, or one was held, by its reason.
    """
    made = Pockets(cell, _Job("", pocket, pockets=pockets, made=planner), velocity_model(None))
    reasons, records = run_in_memory(made.parts(), conduct)
    for name, reason in reasons.items():
        raise ValueError(f"{name} was held: {reason}")
    return made.milled(records)
