"""Joint angles along a path at constant orientation, and a feed that begins and ends softly."""

import numpy as np
import pytest

from stagectl.robot.arm import irb140
from stagectl.robot.kinematics import forward
from stagectl.robot.tool_path import joints_at, ramped


def test_the_tool_is_where_it_is_wanted_and_turned_as_at_home() -> None:
    arm, home = irb140().with_tool(0.1), np.radians([0.0, 20.0, 10.0, 0.0, 60.0, 0.0])
    there = forward(arm, home)
    wanted = there[:3, 3] + np.random.default_rng(1).uniform(-0.03, 0.03, (20, 3))
    found = forward(arm, joints_at(arm, home, wanted))
    assert found[:, :3, 3] == pytest.approx(wanted, abs=1e-12)
    assert found[:, :3, :3] == pytest.approx(np.tile(there[:3, :3], (20, 1, 1)), abs=1e-9)


def test_a_way_that_the_arm_cannot_reach_is_refused() -> None:
    arm, home = irb140(), np.radians([0.0, 0.0, 0.0, 0.0, 89.0, 0.0])
    with pytest.raises(ValueError, match="does not reach"):
        joints_at(arm, home, forward(arm, home)[:3, 3] + np.array([[0.0, 0.0, -0.8]]))


def test_the_feed_rises_and_falls_and_all_of_the_way_is_gone() -> None:
    time = np.linspace(-1.0, 5.0, 6001)
    way = ramped(time, 3.0, 0.5)
    assert way[0] == 0.0
    assert way[-1] == pytest.approx(3.0)
    speed = np.gradient(way, time)
    assert speed.max() == pytest.approx(1.0, abs=1e-6)
    assert speed[(time < 0.0) | (time > 3.5)].max() < 1e-3
    assert np.abs(np.diff(speed)).max() < 0.01
