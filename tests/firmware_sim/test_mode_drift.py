"""Modes that walk at random, move steadily, or jump."""

import numpy as np
import pytest

from firmware_sim.plants.mode_drift import FARTHEST, Drift, ModeDrift

POLES = np.array([-3.0 + 200j, -5.0 + 900j, -2.0 + 1500j, -800.0 + 0j])
STEP = 0.1


def factors(drift: Drift, seconds: float, seed: int = 1) -> np.ndarray:
    """Return how far each pole has moved at each step, shape (steps, 4)."""
    moving, factor, rows = ModeDrift(drift, POLES, seed), np.ones(4), []
    for _ in range(round(seconds / STEP)):
        moving.step(STEP, factor)
        rows.append(factor.copy())
    return np.array(rows)


def test_a_walk_spreads_with_the_root_of_time_each_mode_by_itself() -> None:
    walk = 1e-3
    ends = np.array([factors(Drift(walk=walk), 60.0, seed)[[149, -1]] for seed in range(150)]) - 1
    np.testing.assert_allclose(ends[:, 1, :3].std(), walk, rtol=0.12)
    np.testing.assert_allclose(ends[:, 0, :3].std(), walk / 2, rtol=0.12)
    assert np.abs(np.corrcoef(ends[:, 1, :3].T)[np.triu_indices(3, 1)]).max() < 0.3


def test_a_walk_is_reflected_before_it_goes_too_far() -> None:
    walked = factors(Drift(walk=0.05), 600.0)[:, :3] - 1
    assert np.abs(walked).max() <= FARTHEST
    assert np.abs(walked).max() > 0.8 * FARTHEST


def test_a_trend_moves_all_modes_alike_and_then_ends() -> None:
    moved = factors(Drift(trend=-0.03, trend_seconds=20.0), 40.0)
    time = STEP * np.arange(len(moved))
    np.testing.assert_allclose(moved[:, :3], np.repeat(1 - 0.03 * np.minimum(time / 20, 1)[:, None], 3, axis=1))


def test_a_jump_moves_one_mode_once_by_its_own_width() -> None:
    moved = factors(Drift(jump_mode=1, jump_widths=2.0, jump_at=5.0), 10.0)
    width = 2 * 5.0 / abs(POLES[1])
    np.testing.assert_allclose(moved[:49], 1.0)
    np.testing.assert_allclose(moved[51:], [1, 1 + 2 * width, 1, 1] * np.ones((len(moved) - 51, 1)))


@pytest.mark.parametrize("drift", [Drift(walk=0.01), Drift(trend=0.1), Drift(jump_widths=1.0)])
def test_what_does_not_ring_stays(drift: Drift) -> None:
    assert (factors(drift, 100.0)[:, 3] == 1.0).all()
    assert not drift.is_still


def test_nothing_moves_by_itself() -> None:
    assert Drift().is_still
