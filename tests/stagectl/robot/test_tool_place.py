"""Joint angles for places of the tool."""

import numpy as np
import pytest

from stagectl.robot.arm import irb140
from stagectl.robot.kinematics import forward
from stagectl.robot.tool_place import ToolPlace

HOME = np.array([0.0, 0.0, 0.0, 0.0, 0.5 * np.pi, 0.0])
ARM = irb140().with_tool(0.1)


def followed(place: np.ndarray) -> np.ndarray:
    """Return the joint angles for places from home, shape (samples, 6), rad."""
    block = ToolPlace(irb140(), 0.1, HOME, forward(ARM, HOME)[:3, 3])
    block.prepare(250.0, len(place))
    angle = np.zeros((len(place), 6))
    block.process(place, angle)
    return angle


def test_places_of_a_path_are_met_and_the_tool_keeps_its_direction() -> None:
    time = np.arange(1000) / 250.0
    wave = 0.5 - 0.5 * np.cos(np.pi * time / 4)
    place = 30e-3 * np.column_stack([np.sin(3 * time) * wave, np.cos(2 * time) * wave, 0.2 * wave])
    frame = forward(ARM, followed(place))
    np.testing.assert_allclose(frame[:, :3, 3] - forward(ARM, HOME)[:3, 3], place, atol=2e-6)
    np.testing.assert_allclose(frame[:, :3, :3], np.broadcast_to(forward(ARM, HOME)[:3, :3], (1000, 3, 3)), atol=1e-5)


def test_a_place_that_stands_is_met_exactly() -> None:
    place = np.repeat(np.linspace(0.0, 5e-3, 50), 5)[:, None] * np.ones(3)
    at = forward(ARM, followed(np.vstack([place, place[-1:].repeat(5, axis=0)])))[-1, :3, 3]
    np.testing.assert_allclose(at - forward(ARM, HOME)[:3, 3], 5e-3, atol=1e-12)


def test_a_home_outside_the_limits_is_refused() -> None:
    with pytest.raises(ValueError, match="joint 5 is at"):
        ToolPlace(irb140(), 0.1, np.full(6, 3.0) * (np.arange(6) == 4), np.zeros(3))
