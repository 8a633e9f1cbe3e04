"""The path is the circle it says, at its feed, and the joints take the workpiece there without turning it."""

import numpy as np
import pytest

from stagectl.experiments.toroid.plan import cell_of
from stagectl.experiments.toroid.toroid_path import ToroidPath
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.port import arm_of
from stagectl.robot.toroid_config import Toroid

PATH = ToroidPath(Toroid())


def test_the_way_is_the_circle_at_its_feed_from_rest_to_rest() -> None:
    time = np.arange(round(PATH.seconds * 250)) / 250
    way = PATH.way(time)
    assert way[0] == way[round(250 * Toroid().lead)] == 0.0
    assert way[-1] == pytest.approx(2 * np.pi * 0.035)
    speed = np.diff(way) * 250
    assert speed.min() >= 0.0
    assert speed.max() == pytest.approx(5e-3)
    assert np.abs(np.diff(speed)).max() * 250 < 5e-3 * np.pi / 2 / 0.5 * 1.01  # a raised cosine's steepest


def test_a_part_shorter_than_its_ramps_has_shorter_ones() -> None:
    path = ToroidPath(Toroid(turn=0.005))
    way = path.way(np.linspace(0.0, path.seconds, 2_000))
    assert np.all(np.diff(way) >= 0.0)
    assert way[-1] == pytest.approx(path.length)


def test_the_joints_move_the_workpiece_around_the_tool_without_turning_it() -> None:
    cell = cell_of(CellConfig())
    arm = arm_of(cell).with_tool(cell.robot.tool)
    time = np.linspace(0.0, PATH.seconds, 200)
    poses, middle = forward(arm, PATH.joints(arm, time)), forward(arm, np.array(Toroid().home))
    np.testing.assert_allclose(middle[:3, 3] - poses[:, :3, 3], PATH.wanted(time), atol=1e-12)
    np.testing.assert_allclose(poses[:, :3, :3], np.broadcast_to(middle[:3, :3], (200, 3, 3)), atol=1e-12)


def test_it_begins_at_the_top_and_goes_round_from_z_to_minus_y() -> None:
    wanted = PATH.wanted(np.array([0.0, Toroid().lead + 5.0]))
    np.testing.assert_allclose(wanted[0], [0.0, 0.0, 0.035], atol=1e-12)
    assert wanted[1, 1] < 0.0 < wanted[1, 2]


def test_a_circle_out_of_reach_is_refused() -> None:
    cell = cell_of(CellConfig())
    with pytest.raises(ValueError, match="joint 5 is at"):
        ToroidPath(Toroid(home=(0.0, 0.0, 0.0, 0.0, 2.18, 0.0))).joints(arm_of(cell), np.linspace(0, 40, 50))
