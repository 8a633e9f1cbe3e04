"""A pocket of a strip or two of 20 mm, milled in the simulated cell."""

from collections.abc import Mapping, Sequence

from rigkit import config as rig_file
from rigkit.experiment.runner import Conduct, remembered
from stagectl.experiments.feed.feed_graph import FeedGraph
from stagectl.experiments.feed.job import RATES
from stagectl.experiments.feed.plan import FeedPlan, feed_plan
from stagectl.experiments.feed.pocket_part import pocket_part
from stagectl.experiments.feed.pocketed import Pocketed
from stagectl.experiments.feed.surroundings import Surroundings, simulated
from stagectl.link.tell import nobody
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.nominal_velocity import nominal_velocity

SECONDS = 30.0
LENGTH = 20e-3
"""m that the tool goes along a strip."""
QUICK = (
    "segments.travel=0.2", "segments.plunge=0.1", "segments.stationary=0.2", "segments.slowest=0.1",
    "feed_plants.cut_options.knots=0",
)  # fmt: skip
"""Settings that leave out what takes long."""


def small(settings: Sequence[str] = (), rows: int = 3, feeds: Mapping[str, float] | None = None) -> FeedPlan:
    """Return the plan of a pocket whose strips have `LENGTH`."""
    pocket = Pocket(rows, 13, 3, "EW", RATES, v_lift=50.0)
    cell = rig_file.load(None, CellConfig, [*QUICK, *settings])
    return feed_plan(cell, pocket, nominal_velocity(250.0), feeds=feeds)


def milled(plan: FeedPlan, surroundings: Surroundings = simulated, conduct: Conduct | None = None) -> Pocketed:
    """Mill it; recorded surroundings say what they once did."""
    cell = FeedGraph(plan, lambda: planner("exact", plan.pocket), nobody, surroundings)
    records, ended = remembered(pocket_part(cell, SECONDS), conduct or Conduct())
    return Pocketed(records[plan.name], tuple(cell.segments.done), ended.reason)
