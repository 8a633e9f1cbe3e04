"""Force control on a cell that was drawn by seed: its file names plants that find speed and force together."""

import numpy as np
import pytest

from firmware_sim.population.cell_population import CELLS
from rigkit import config as rig_file
from rigkit.toml_text import value_text
from stagectl.experiments.feed.job import RATES
from stagectl.experiments.feed.plan import FeedPlan, feed_plan
from stagectl.experiments.feed.process_run import channel
from stagectl.planning.problem import Pocket
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.feed_force import PHASES
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from tests.stagectl.experiments.feed.small_pocket import milled


def drawn(seed: int, family: str) -> FeedPlan:
    """Return the plan of a slot of 20 mm in a drawn cell."""
    keys = CELLS.draw(seed, family).keys | {"segments.travel": 0.2}
    cell = rig_file.load(None, CellConfig, [f"{key}={value_text(value)}" for key, value in keys.items()])
    return feed_plan(cell, Pocket(3, 13, 3, "EW", RATES, v_lift=50.0), nominal_velocity(250.0))


def test_the_force_wanted_is_held_in_a_drawn_cut() -> None:
    plan = drawn(1000, "power")
    done = milled(plan)
    assert done.reason == ""
    on = channel(done.recording, "phase") == PHASES.index("controlling")
    force = np.hypot(*(channel(done.recording, f"true_force_{axis}") for axis in "xy"))[on & np.roll(on, 60)]
    assert force.mean() == pytest.approx(plan.cell.force.force, rel=0.1)
