"""The closed form of the outer LQI problem against scipy's Riccati solver."""

import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_are

from stagectl.robot.milling import force_gain_kernel as kernel
from stagectl.robot.milling.feed_record import OUTER

H = 0.004


def outer_of(*values: float) -> np.record:
    """Return an outer problem: K_f, 1 / lag, weights of integral, velocity and feed, and the period."""
    outer: np.record = np.zeros(1, OUTER).view(np.recarray)[0]
    for name, value in zip(OUTER.names or (), values, strict=False):
        outer[name] = value
    return outer


def process(kappa: float, wide: float, settings: np.record) -> tuple[np.ndarray, np.ndarray]:
    """Sample velocity loop, force and the integral of its error, from (7.20) and (7.22)."""
    stiffness, lag = settings.stiffness, settings.lag
    flow = np.array([[-lag, 0.0, lag], [stiffness * wide, -stiffness * kappa, 0.0], [0.0, 0.0, 0.0]])
    held = expm(flow * H)
    transition = np.eye(3)
    transition[:2, :2], transition[2, 1] = held[:2, :2], -H
    return transition, np.append(held[:2, 2], 0.0)[:, None]


def by_riccati(kappa: float, wide: float, settings: np.record) -> tuple[np.ndarray, np.ndarray]:
    """Return the gains on velocity, force and integral, and the closed loop's poles."""
    transition, drive = process(kappa, wide, settings)
    cost = np.diag([settings.velocity, 1.0, settings.integral])
    effort = np.array([[kernel.control_weight(kappa, wide, settings)]])
    answer = solve_discrete_are(transition, drive, cost, effort)
    gains = np.linalg.solve(drive.T @ answer @ drive + effort, drive.T @ answer @ transition)
    return gains[0], np.linalg.eigvals(transition - drive @ gains)


def settings_of(rng: np.random.Generator) -> np.record:
    settings = outer_of()
    settings.stiffness, settings.lag = 10 ** rng.uniform(4, 5.5), 10 ** rng.uniform(0.5, 2.3)
    settings.integral, settings.control = 10 ** rng.uniform(1, 4), 10 ** rng.uniform(-2, 2)
    settings.velocity, settings.period = rng.choice([0.0, 1e5]), H
    return settings


def test_the_closed_form_is_the_solution_of_the_riccati_equation() -> None:
    rng, worst = np.random.default_rng(7), 0.0
    for _ in range(300):
        kappa, wide, settings = 10 ** rng.uniform(-5, -1.5), rng.uniform(1.0, 2.0), settings_of(rng)
        kappa = min(kappa, kernel.FASTEST / (H * settings.stiffness))
        found = np.array(kernel.gains(kappa, wide, settings)) * [1.0, 1.0, -1.0]
        wanted = by_riccati(kappa, wide, settings)[0]
        worst = max(worst, float(np.abs(found - wanted).max() / np.abs(wanted).max()))
    assert worst < 1e-6


@pytest.mark.parametrize("kappa", [1e-4, 4e-4, 1e-3, 4e-3])
def test_the_closed_loop_is_well_damped_for_every_kappa(kappa: float) -> None:
    settings = outer_of(75e3, 1 / 0.018, 0.05**-2, 0.0, 1.0, H)
    transition, drive = process(kappa, 1.1, settings)
    gains = np.array(kernel.gains(kappa, 1.1, settings)) * [1.0, 1.0, -1.0]
    poles = np.log(np.linalg.eigvals(transition - drive @ gains[None]).astype(complex)) / H
    assert poles.real.max() < -12.0
    assert (np.abs(poles.imag) <= 1.05 * np.abs(poles.real)).all()


def test_the_process_is_sampled_exactly_where_both_poles_coincide() -> None:
    settings = outer_of(75e3, 30.0, 1.0, 0.0, 1.0, H)
    slow_v, slow_f, n0, n1 = kernel.sampled(30.0 / 75e3, 1.2, settings)
    transition, drive = process(30.0 / 75e3, 1.2, settings)
    assert slow_v == pytest.approx(1.0 - transition[0, 0])
    assert slow_f == pytest.approx(1.0 - transition[1, 1])
    assert n1 == pytest.approx(drive[1, 0])
    assert n0 == pytest.approx(transition[1, 0] * drive[0, 0] + drive[1, 0] * slow_v)


@pytest.mark.parametrize("kappa", [0.03, 0.1])
def test_a_force_that_follows_the_feed_within_a_sample_has_gains_as_well(kappa: float) -> None:
    settings = outer_of(3e5, 1 / 0.018, 0.05**-2, 0.0, 1.0, H)
    gains = np.array(kernel.gains(kappa, 3.0, settings))
    assert np.isfinite(gains).all()
    assert gains[2] > 0.0
