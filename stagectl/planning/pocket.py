"""A pocket, the paths that planners make for it, and whether a path is one."""

from collections.abc import Callable
from pathlib import Path

from stagectl.planning.exact import ExactPlanner
from stagectl.planning.features import FeaturesPlanner
from stagectl.planning.milling import Planner, mill
from stagectl.planning.planner_names import PLANNERS, UNTRAINED
from stagectl.planning.pocket_check import Verdict, check
from stagectl.planning.problem import Pocket, PocketFault
from stagectl.planning.qlearning import QLearningPlanner
from stagectl.planning.rate_belief import BELIEVED, believed, measured, unknown
from stagectl.planning.rate_scales import Scales
from stagectl.planning.sequential import SequentialPlanner, trained
from stagectl.planning.uncertain import UncertainPlanner

__all__ = ["PLANNERS", "Pocket", "PocketFault", "Verdict", "check", "plan", "planner", "untrained"]

MAKERS: dict[str, Callable[[Pocket, int], Planner]] = {
    "exact": lambda pocket, _: ExactPlanner(pocket),
    "sequential": lambda pocket, _: SequentialPlanner(pocket, trained(pocket)),
    "qlearning": QLearningPlanner,
    "features": FeaturesPlanner,
    "uncertain": lambda pocket, _: UncertainPlanner(pocket, measured(pocket)),
}
"""Each of `PLANNERS`, of a pocket and a seed."""


def planner(name: str, pocket: Pocket, seed: int = 0, prior: Path | None = None) -> Planner:
    """Make a planner by name, which knows what is believed of a pocket.

    Parameters
    ----------
    name : str
        Of `PLANNERS`.
    pocket : Pocket
    seed : int
        Of what it draws.
    prior : Path, optional
        The file in which `uncertain` keeps how far rates were off, from which it estimates the scales of its prior.

    Raises
    ------
    PocketFault : there is no such planner, or it has no prior.
    ValueError, OSError : as of `Scales`.
    """
    if name not in PLANNERS:
        raise PocketFault(f"planner is {name!r}, must be one of {', '.join(PLANNERS)}")
    if prior is not None:
        if name != "uncertain":
            raise PocketFault(f"planner is {name!r}, must be uncertain to keep a prior in {prior}")
        return UncertainPlanner(pocket, believed(pocket), Scales(BELIEVED, prior))
    return MAKERS[name](pocket, seed)


def untrained(name: str, pocket: Pocket) -> Planner:
    """Make a planner by name that trains itself: it does not know the pocket's rates."""
    if name == "sequential":
        return SequentialPlanner(pocket, {})
    if name == "uncertain":
        return UncertainPlanner(pocket, unknown(pocket))
    raise PocketFault(f"planner is {name!r}, must be one of {', '.join(UNTRAINED)} to train itself")


def plan(pocket: Pocket, planner_name: str, seed: int = 0) -> list[list[str | int]]:
    """Plan and mill a pocket: the planner knows what is believed, and of each finished segment what was really paid.

    Parameters
    ----------
    pocket : Pocket
    planner_name : str
        Of `PLANNERS`.
    seed : int
        Of what a planner draws.

    Returns
    -------
    list of [type, row, col, feed]

    Examples
    --------
    >>> pocket = Pocket(4, 3, 2, "EW", {"E2": 1, "E1u": 1, "E1d": 1, "W2": 1, "W1u": 1, "W1d": 1})
    >>> check(pocket, plan(pocket, "exact")).total
    6.0
    """
    return [each.in_path for each in mill(pocket, planner(planner_name, pocket, seed))]
