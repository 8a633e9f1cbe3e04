"""The pocket's path: where it goes, how fast, and what of it is refused."""

import numpy as np
import pytest

from stagectl.experiments.trials.pocket_path import pocket_path
from stagectl.experiments.trials.rounded_path import rounded
from stagectl.experiments.trials.tool_path import RATE, ToolPath, refuse_outside
from stagectl.robot.pocket_config import Pocket


@pytest.fixture(scope="module")
def path() -> ToolPath:
    return pocket_path(Pocket())


def test_a_corner_becomes_an_arc_of_its_radius() -> None:
    points, way = rounded(np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.01, 0.01, 0.0]]), 2e-3)
    centre = np.array([8e-3, 2e-3, 0.0])
    bent = (points[:, 0] > 8e-3) & (points[:, 1] < 2e-3)
    assert np.linalg.norm(points[bent] - centre, axis=1) == pytest.approx(2e-3, abs=1e-9)
    assert way[-1] == pytest.approx(0.02 - 4e-3 + np.pi * 1e-3, rel=1e-5)
    assert np.diff(way).max() < 5.1e-6


def test_an_arc_takes_no_more_than_half_of_a_side_and_straight_on_stays_straight() -> None:
    points, way = rounded(np.array([[0, 0, 0], [1e-3, 0, 0], [2e-3, 0, 0], [2e-3, 1e-3, 0]], float), 5e-3)
    assert way[-1] == pytest.approx(1.5e-3 + 0.25 * np.pi * 1e-3 + 0.5e-3, rel=1e-5)
    assert points[-1] == pytest.approx([2e-3, 1e-3, 0.0])


def test_the_finished_pocket_has_its_size_and_depth(path: ToolPath) -> None:
    pocket = path.pocket
    reach = 0.5 * (pocket.size[0] - pocket.tool)
    assert path.wanted[:, :2].max(axis=0) == pytest.approx([reach, reach], abs=2e-6)
    assert path.wanted[:, :2].min(axis=0) == pytest.approx([-reach, -reach], abs=2e-6)
    assert path.wanted[:, 2].min() == pytest.approx(-pocket.depth)


def test_all_of_the_floor_is_reached(path: ToolPath) -> None:
    """Every point of the floor, but for the corners' radii, comes within the tool's radius at full depth."""
    deep = path.wanted[path.wanted[:, 2] < -path.pocket.depth + 1e-9, :2][::3]
    grid = np.linspace(-13.5e-3, 13.5e-3, 28)
    for x in grid:
        for y in grid:
            if min(abs(x), abs(y)) <= 9e-3:
                assert np.hypot(*(deep - [x, y]).T).min() < 0.5 * path.pocket.tool


def test_it_rests_at_its_ends_and_never_exceeds_its_feed(path: ToolPath) -> None:
    speed = np.linalg.norm(np.diff(path.wanted, axis=0), axis=1) * RATE
    assert speed.max() <= path.pocket.feed * (1 + 1e-9)
    assert speed[: round(path.pocket.lead * RATE) - 1].max() == 0.0
    assert speed[-round(0.9 * path.pocket.tail * RATE) :].max() == 0.0
    assert path.wanted[[0, -1], 2] == pytest.approx(path.pocket.clearance)


def test_it_descends_no_steeper_than_it_may(path: ToolPath) -> None:
    step = np.diff(path.wanted[: round(len(path.wanted) * 0.6)], axis=0)
    down = step[:, 2] < -1e-9
    across = np.hypot(step[down, 0], step[down, 1])
    moves = across > 1e-7
    assert (-step[down, 2][moves] / across[moves]).max() <= path.pocket.slope * 1.05


@pytest.mark.parametrize(
    ("move", "words"),
    [
        ([0.014, 0.0, 0.0], "leaves the workpiece: at .* s the tool is predicted at x = 2"),
        ([0.0, 0.0, -0.004], "leaves the workpiece: the tool is predicted at z = -6.000 mm"),
        ([0.0, 0.0021, 0.0], r"2.100 mm from where it is wanted, must be <= 2.000 mm \(learning.stray\)"),
        ([np.nan, 0.0, 0.0], "the path leaves the workpiece"),
    ],
)
def test_a_path_out_of_the_workpiece_is_refused(path: ToolPath, move: list[float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        refuse_outside(path.pocket, path.wanted, path.wanted + move, 2e-3)


def test_a_path_near_the_wanted_one_is_let_through(path: ToolPath) -> None:
    refuse_outside(path.pocket, path.wanted, path.wanted + 1e-3, 2e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"size": (9e-3, 28e-3)}, "the tool and four corners"),
        ({"step": 7e-3}, "must be <= pocket.tool"),
        ({"workpiece": (29e-3, 50e-3, 6e-3)}, "must leave pocket.wall"),
    ],
)
def test_a_pocket_that_cannot_be_is_refused(change: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Pocket(**change)
