"""The simulated cut: the tool's place in the workpiece, and forces that answer feed and depth."""

import numpy as np
import pytest

from firmware_sim.plants.toroid_cut import SHARES, ToroidCut

RATE, RADIUS = 10_000.0, 0.035
START = 0.05


def mill(
    seconds: float, feed: float = 5e-3, deeper: float = 0.0, wider: float = 0.0, stop: float = np.inf
) -> dict[str, np.ndarray]:
    """Mill with a workpiece that a robot moves exactly, from its centre at (1, 2, 3)."""
    cut = ToroidCut(RATE, start=START, seconds=0.5, tool=1e-3)
    time = np.arange(round(seconds * RATE)) / RATE
    since = np.clip(time - START, 0.0, stop)
    angle = 0.5 * np.pi + since * feed / RADIUS
    size = np.where(time > START, RADIUS + wider, RADIUS)
    tool = np.zeros((len(time), 3))
    tool[time > START, 0] = deeper
    away = np.column_stack([np.zeros(len(time)), size * np.cos(angle), size * np.sin(angle)])
    workpiece = np.array([1.0, 2.0, 3.0]) - away
    names = ("force", "moment", "plate_force", "cut", "face")
    made = {name: np.empty((len(time), 3)) for name in names}
    cut.run(tool, workpiece, np.tile([1.0, 0.0, 0.0, 0.0], (len(time), 1)), *made.values())
    return made | {"away": away, "angle": angle[:, None]}


@pytest.fixture(scope="module")
def milled() -> dict[str, np.ndarray]:
    return mill(0.8)


def test_the_tool_is_where_the_robot_has_moved_the_workpiece_from_under_it(milled: dict[str, np.ndarray]) -> None:
    np.testing.assert_allclose(milled["cut"], milled["away"], atol=5e-6)  # 0.5 ms at 5 mm/s


def test_nothing_happens_before_the_start(milled: dict[str, np.ndarray]) -> None:
    assert np.abs(milled["plate_force"][: round(START * RATE)]).max() == 0.0


def test_the_full_force_is_its_parts_along_normal_feed_and_axis(milled: dict[str, np.ndarray]) -> None:
    force, angle = milled["plate_force"][5_000:], milled["angle"][5_000:, 0]
    normal = force[:, 1] * np.cos(angle) + force[:, 2] * np.sin(angle)
    along = -force[:, 1] * np.sin(angle) + force[:, 2] * np.cos(angle)
    mean = 100.0 * np.array(SHARES)
    np.testing.assert_allclose([normal.mean(), -along.mean(), -force[:, 0].mean()], mean, rtol=0.25)
    assert normal.std() > 0.3 * normal.mean()  # teeth


def test_the_robot_feels_the_opposite_averaged_and_its_moment(milled: dict[str, np.ndarray]) -> None:
    part = slice(5_000, 8_000)
    np.testing.assert_allclose(milled["force"][part].mean(axis=0), -milled["plate_force"][part].mean(axis=0), rtol=0.02)
    assert milled["force"][part].std(axis=0).max() < 0.6 * milled["plate_force"][part].std(axis=0).max()
    wanted = np.cross(milled["away"][part], -milled["plate_force"][part]).mean(axis=0)
    np.testing.assert_allclose(milled["moment"][part].mean(axis=0), wanted, rtol=0.05, atol=0.02)


def test_the_force_grows_with_feed_and_depth_and_ends_with_the_feed() -> None:
    size = {
        name: np.linalg.norm(done["plate_force"][6_000:8_000], axis=1).mean()
        for name, done in {
            "full": mill(0.8),
            "deeper": mill(0.8, deeper=0.25e-3),
            "slower": mill(0.8, feed=4e-3),
            "stopped": mill(0.8, stop=0.5),
        }.items()
    }
    assert size["deeper"] / size["full"] == pytest.approx(1.5, rel=0.05)
    assert size["slower"] / size["full"] == pytest.approx(0.84, rel=0.05)
    assert size["stopped"] < 1e-3 * size["full"]


def test_what_is_too_deep_or_too_far_out_shows_in_the_cut_and_along_x_to_the_laser() -> None:
    done = mill(0.5, deeper=40e-6, wider=30e-6)
    cut = done["cut"][3_000:]
    np.testing.assert_allclose(cut[:, 0], 40e-6, atol=1e-9)
    np.testing.assert_allclose(np.hypot(cut[:, 1], cut[:, 2]) - RADIUS, 30e-6, atol=1e-7)
    np.testing.assert_allclose(done["face"][3_000:], 0.0, atol=1e-9)  # the robot did not move along x


def test_an_option_out_of_range_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="simulator.options.radius is 1.0, must be 0.005 to 0.5 m"):
        ToroidCut(RATE, radius=1.0)
