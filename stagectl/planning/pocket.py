"""A pocket, the paths that planners make for it, and whether a path is one."""

from stagectl.planning.exact import ExactPlanner
from stagectl.planning.milling import Planner, mill
from stagectl.planning.pocket_check import Verdict, check
from stagectl.planning.problem import Pocket, PocketFault

__all__ = ["PLANNERS", "Pocket", "PocketFault", "Verdict", "check", "plan", "planner"]

PLANNERS = ("exact",)


def planner(name: str, pocket: Pocket) -> Planner:
    """Make a planner by name."""
    if name not in PLANNERS:
        raise PocketFault(f"planner is {name!r}, must be one of {', '.join(PLANNERS)}")
    return ExactPlanner(pocket)


def plan(pocket: Pocket, planner_name: str) -> list[list[str | int]]:
    """Plan and mill a pocket: the planner knows what is believed, and of each finished segment what was really paid.

    Parameters
    ----------
    pocket : Pocket
    planner_name : str
        Of `PLANNERS`.

    Returns
    -------
    list of [type, row, col, feed]

    Examples
    --------
    >>> pocket = Pocket(4, 3, 2, "EW", {"E2": 1, "E1u": 1, "E1d": 1, "W2": 1, "W1u": 1, "W1d": 1})
    >>> check(pocket, plan(pocket, "exact")).total
    6.0
    """
    return [each.in_path for each in mill(pocket, planner(planner_name, pocket))]
