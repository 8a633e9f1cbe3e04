"""The order in which a pocket is milled, strip by strip, by planners that learn, or the optimum.

`Pocket` is what is to be milled; `plan` returns a path, `check` says whether one mills it and what it costs; `planner`
and `untrained` make a `Planner` by its name, which `mill` takes through a pocket and tells what each segment took.

Examples
--------
>>> rate = {"E2": 0.05, "E1u": 0.04, "E1d": 0.06, "W2": 0.05, "W1u": 0.04, "W1d": 0.06}
>>> pocket = Pocket(4, 6, 2, "EW", rate)
>>> path = plan(pocket, "exact")
>>> check(pocket, path).total <= check(pocket, plan(pocket, "sequential")).total
True
"""

from stagectl.planning.exact import ExactPlanner, least_time
from stagectl.planning.milling import Milled, Planner, mill
from stagectl.planning.pocket import PLANNERS, plan, planner, untrained
from stagectl.planning.pocket_check import Verdict, check
from stagectl.planning.problem import Pocket, PocketFault

__all__ = [
    "PLANNERS",
    "ExactPlanner",
    "Milled",
    "Planner",
    "Pocket",
    "PocketFault",
    "Verdict",
    "check",
    "least_time",
    "mill",
    "plan",
    "planner",
    "untrained",
]
