"""Intervals of 95 % of forces from motor torques: what they hold, and that they stay within the bounds."""

import numpy as np
import pytest

from stagectl.robot.kinematics import jacobian
from stagectl.robot.milling.force_interval import force_intervals
from tests.stagectl.robot.milling.force_cases import COULOMB, NOISE
from tests.stagectl.robot.milling.torque_models import ARM, angles, wide_model

RATE, SAMPLES = 250.0, 2_000
FORCE = np.array([30.0, -20.0, 10.0])


def a_record(friction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return angles of arms at rest, a gap before each, and their torques with friction (samples, 6), N m."""
    angle = np.full((2 * len(friction), 6), np.nan)
    angle[1::2] = angles(len(friction))
    noise = NOISE * np.random.default_rng(5).standard_normal(friction.shape)
    torque = np.full(angle.shape, np.nan)
    load = -np.einsum("nfj,f->nj", jacobian(ARM, angle[1::2])[:, :3], FORCE)
    torque[1::2] = wide_model().gravity.torque(ARM, angle[1::2]) + load + friction + noise
    return angle, torque


def intervals(friction: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return low and high of the intervals, then of the bounds, where there is no gap."""
    angle, torque = a_record(friction)
    model = wide_model()
    found = model.estimate(angle, torque, RATE)
    likely = force_intervals(model, found, angle, torque, RATE)
    assert np.isinf(likely.low[::2]).all()
    return likely.low[1::2], likely.high[1::2], found.low[1::2], found.high[1::2]


def test_friction_evenly_within_its_range_gives_95_percent() -> None:
    friction = COULOMB * np.random.default_rng(4).uniform(-1, 1, (SAMPLES, 6))
    low, high, *_ = intervals(friction)
    held = ((low <= FORCE) & (high >= FORCE)).mean(axis=0)
    assert (held > 0.94).all()
    assert (held < 0.995).all()


def test_they_lie_within_the_bounds_and_are_narrower() -> None:
    friction = COULOMB * np.random.default_rng(4).uniform(-1, 1, (SAMPLES, 6))
    low, high, least, most = intervals(friction)
    assert (least <= low).all()
    assert (low <= high).all()
    assert (high <= most).all()
    assert np.median((high - low) / (most - least)) < 0.9


@pytest.mark.parametrize("shake", [0.0, 1e-4])
def test_an_arm_that_is_shaken_has_wider_intervals(shake: float) -> None:
    model, angle = wide_model(), np.tile([0.1, 0.3, 0.2, 0.1, 1.0, 0.2], (100, 1))
    torque = model.gravity.torque(ARM, angle)
    moved = angle.copy()
    moved[50:] += shake
    likely = force_intervals(model, model.estimate(moved, torque, RATE), moved, torque, RATE)
    width = (likely.high - likely.low)[:, 0]
    assert (width[52] > 1.05 * width[40]) == (shake > 0.0)
