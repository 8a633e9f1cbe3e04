"""Cartesian corrections against the Jacobian, solved in another way."""

import dataclasses

import numpy as np
import pytest

from stagectl.robot.arm import irb140
from stagectl.robot.cartesian_correction import CartesianCorrection
from stagectl.robot.kinematics import forward, jacobian

HOME = np.radians([10.0, 20.0, -10.0, 30.0, 40.0, 5.0])


def corrected(angle: np.ndarray, move: np.ndarray, tool: float = 0.0) -> np.ndarray:
    """Return joint corrections, shape (samples, 6), rad."""
    block, found = CartesianCorrection(irb140(), tool), np.full((len(angle), 6), np.nan)
    block.prepare(250.0, len(angle))
    block.process(angle, move[:, :3].copy(), move[:, 3:].copy(), found)
    return found


def test_it_is_the_inverse_of_the_jacobian_where_that_is_regular() -> None:
    rng = np.random.default_rng(1)
    angle = HOME + rng.uniform(-0.3, 0.3, (50, 6))
    move = rng.uniform(-4e-4, 4e-4, (50, 6))
    expected = np.linalg.solve(jacobian(irb140(), angle), move[..., None])[..., 0]
    np.testing.assert_allclose(corrected(angle, move), expected, atol=1e-12)


def test_it_moves_the_tool_and_not_the_flange() -> None:
    arm, move, tool = irb140(), np.array([[5e-4, -3e-4, 2e-4, 0.0, 0.0, 0.0]]), 0.2
    after = forward(arm, HOME + corrected(HOME[None], move, tool)[0])
    before = forward(arm, HOME)
    moved = after[:3, 3] + tool * after[:3, 2] - before[:3, 3] - tool * before[:3, 2]
    np.testing.assert_allclose(moved, move[0, :3], atol=1e-6)
    np.testing.assert_allclose(after[:3, :3], before[:3, :3], atol=1e-6)


@pytest.mark.parametrize("bend", [0.0, 1e-9, 1e-4, 3e-3])
def test_near_a_singularity_it_stays_bounded(bend: float) -> None:
    """The wrist stretched: exactly inverted, 0.5 mm would turn joints 4 and 6 without bound."""
    angle = HOME.copy()
    angle[4] = bend
    found = corrected(angle[None], np.array([[0.0, 5e-4, 0.0, 0.0, 0.0, 1e-3]]))
    assert np.abs(found).max() < 0.1


@pytest.mark.parametrize("bend", np.geomspace(1e-9, 0.3, 20))
def test_near_a_singularity_what_is_not_lost_is_still_corrected(bend: float) -> None:
    """The wrist stretched: joints 4 and 6 turn about one axis, about which it can always turn."""
    angle = np.radians([10.0, 20.0, -40.0, 30.0, 0.0, -70.0])
    angle[4] = bend
    matrix = jacobian(irb140(), angle)
    turn = np.concatenate([np.zeros(3), 1e-3 * matrix[3:, 3]])
    got = matrix @ corrected(angle[None], turn[None])[0]
    np.testing.assert_allclose(got[3:] @ matrix[3:, 3], 1e-3, rtol=0.01)


def test_an_arm_of_five_joints_is_refused() -> None:
    arm = irb140()
    parts = {name: getattr(arm, name)[:5] for name in ("offset", "d", "a", "alpha", "low", "high", "speed")}
    with pytest.raises(ValueError, match="ABB IRB 140 has 5 joints, must have 6"):
        CartesianCorrection(dataclasses.replace(arm, **parts), 0.1)
