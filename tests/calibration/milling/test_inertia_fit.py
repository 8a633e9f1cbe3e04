"""Inertia of joints from their motion, with friction in the way."""

import numpy as np
import pytest

from calibration.milling.inertia_fit import hats, joint_inertia

RATE = 250.0
TRUE = np.array([6.0, 9.0, 3.0, 0.2, 0.3, 0.05])


def motion() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return angle (rad), speed (rad/s) and acceleration (rad/s^2) of sines, a pace a joint, 60 s."""
    time = np.arange(round(60 * RATE))[:, None] / RATE
    omega = 2 * np.pi * np.geomspace(0.35, 0.75, 6)
    angle = 0.05 / omega * np.sin(omega * time)
    return angle, 0.05 * np.cos(omega * time), -0.05 * omega * np.sin(omega * time)


def test_inertia_is_found_beside_friction_that_falls_with_speed_and_noise() -> None:
    angle, speed, acceleration = motion()
    friction = np.sign(speed) * (1.0 + 0.25 * np.exp(-((speed / 0.02) ** 2))) + 1.2 * speed
    noise = 0.05 * np.random.default_rng(1).normal(size=angle.shape)
    knots = 0.002 * np.sinh(np.linspace(-1, 1, 25) * np.arcsinh(25.0))[:, None] * np.ones(6)
    found = joint_inertia(angle, TRUE * acceleration + friction + noise, knots, RATE)
    assert found == pytest.approx(TRUE, rel=0.05, abs=0.01)


def test_a_joint_that_never_slides_shows_no_inertia() -> None:
    angle, _, acceleration = motion()
    angle[:, 3] = 0.1
    found = joint_inertia(angle, TRUE * acceleration, np.linspace(-1, 1, 5)[:, None] * np.ones(6), RATE)
    assert np.isnan(found[3])
    assert np.isfinite(np.delete(found, 3)).all()


def test_hats_interpolate() -> None:
    knots = np.array([-1.0, 0.0, 2.0])
    weights = hats(np.array([-1.0, -0.25, 0.5, 2.0]), knots)
    assert weights.sum(axis=1) == pytest.approx(np.ones(4))
    assert weights @ knots == pytest.approx([-1.0, -0.25, 0.5, 2.0])
