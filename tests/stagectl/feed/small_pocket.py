"""A pocket of a strip or two of 20 mm, milled in the simulated cell."""

from collections.abc import Mapping, Sequence
from typing import Any

from rigkit import config as rig_file
from stagectl.devices.signals import ROBOT
from stagectl.feed.job import RATES
from stagectl.feed.plan import FeedPlan, feed_plan
from stagectl.feed.recorded import FORCE, TRUE, made
from stagectl.feed.run import Pocketed, mill_pocket
from stagectl.feed.surroundings import Surroundings, simulated
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.trials.conduct import Conduct

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
    """Mill it; of recorded surroundings only what the graph makes is recorded again."""
    signals: tuple[Any, ...] = made(plan.control)
    if surroundings is simulated:
        signals = (*ROBOT, *FORCE, *TRUE, *signals)
    return mill_pocket(
        plan, lambda: planner("exact", plan.pocket), conduct or Conduct(), surroundings, signals, {}, SECONDS
    )
