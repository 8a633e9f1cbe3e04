"""Velocity and force along the feed."""

import numpy as np
import pytest

from stagectl.experiments.feed.constant_feed import ConstantFeed
from stagectl.experiments.feed.feed_seen import FeedSeen
from stagectl.robot.arm import irb140
from stagectl.robot.kinematics import forward

HOME = np.array([0.0, 0.0, 0.0, 0.0, 0.5 * np.pi, 0.0])


def seen(report: np.ndarray, angle: np.ndarray, force: np.ndarray, way: tuple[float, float]) -> list[np.ndarray]:
    block, frames = FeedSeen(irb140(), 0.1), len(report)
    block.prepare(250.0, frames)
    outputs = [np.zeros((frames, 1)), np.zeros((frames, 2))]
    block.process(report[:, None], angle, force, np.tile(way, (frames, 1)), *outputs)
    return outputs


def test_the_velocity_is_that_of_the_tool_along_the_feed() -> None:
    angle = HOME + np.linspace(0.0, 0.01, 50)[:, None] * np.array([1.0, 0.3, 0.0, 0.0, 0.2, 0.0])
    place = forward(irb140().with_tool(0.1), angle)[:, :3, 3]
    velocity = seen(np.arange(1.0, 51.0), angle, np.zeros((50, 3)), (0.6, -0.8))[0][:, 0]
    wanted = np.diff(place @ [0.6, -0.8, 0.0]) * 250.0
    assert velocity[0] == 0.0
    np.testing.assert_allclose(velocity[1:], wanted, rtol=1e-9)


def test_a_report_that_is_missing_is_no_velocity_and_the_next_one_is_the_mean_since() -> None:
    angle = np.repeat(HOME[None], 4, axis=0)
    angle[:, 0] = [0.0, 0.001, 0.001, 0.003]
    velocity = seen(np.array([1.0, 2.0, 2.0, 3.0]), angle, np.zeros((4, 3)), (0.0, 1.0))[0][:, 0]
    assert np.isnan(velocity[2])
    assert velocity[3] == pytest.approx(velocity[1], rel=1e-3)


@pytest.mark.parametrize(
    ("way", "wanted"), [((1.0, 0.0), (-3.0, 4.0)), ((-1.0, 0.0), (3.0, -4.0)), ((0.0, 1.0), (-4.0, -3.0))]
)
def test_the_force_is_split_against_the_feed_and_to_its_left(
    way: tuple[float, float], wanted: tuple[float, float]
) -> None:
    force = np.tile([3.0, 4.0, 50.0], (2, 1))
    along = seen(np.ones(2), np.tile(HOME, (2, 1)), force, way)[1]
    np.testing.assert_allclose(along[1], wanted)


def test_a_constant_feed_is_reached_with_its_acceleration_and_left_at_once() -> None:
    block = ConstantFeed(2.0, 3.0)
    block.prepare(250.0, 20)
    block.change(0.05)
    running = np.concatenate([np.zeros(2), np.ones(12), np.zeros(6)])[:, None]
    outputs = [np.zeros((20, 1)) for _ in range(3)]
    block.process(np.zeros((20, 1)), np.tile([3.0, -4.0], (20, 1)), np.ones((20, 1)), running, *outputs)
    np.testing.assert_allclose(outputs[0][2:9, 0], np.minimum(0.008 * np.arange(1, 8), 0.05))
    assert (outputs[0][14:] == 0.0).all()
    assert (outputs[1] == 5.0).all()
    np.testing.assert_array_equal(outputs[2][:, 0], 3.0 * running[:, 0])


@pytest.mark.parametrize("feed", [0.0, -1.0, float("nan"), float("inf")])
def test_a_feed_that_is_none_is_refused(feed: float) -> None:
    with pytest.raises(ValueError, match="must be finite and > 0"):
        ConstantFeed(2.0, 3.0).change(feed)
