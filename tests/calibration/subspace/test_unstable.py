"""Systems that are unstable, or integrate, and the loops that hold them."""

import numpy as np
import pytest

from calibration import subspace

RATE = 50.0


def ball_and_beam(samples: int, seed: int, noise: float = 0.02) -> tuple[np.ndarray, np.ndarray]:
    """Return angle and position of a ball that rolls on a beam, a double integrator, held by a controller."""
    rng = np.random.default_rng(seed)
    asked = np.repeat(rng.choice([-1.0, 1.0], samples // 25 + 1), 25)[:samples]
    angle, position = np.zeros(samples), np.zeros(samples)
    place, speed = 0.0, 0.0
    for n in range(samples):
        position[n] = place + noise * rng.standard_normal()
        angle[n] = 0.4 * (asked[n] - position[n]) - 0.8 * speed + 0.2 * rng.standard_normal()
        place, speed = place + speed / RATE * 5, speed + (angle[n] + 0.05 * rng.standard_normal()) / RATE * 5
    return angle[:, None], position[:, None]


def pendulum(samples: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return force and angle of a rod that falls, poles at 1.1 and 0.85, and is held."""
    rng = np.random.default_rng(seed)
    state, force, angle = np.zeros(2), np.zeros(samples), np.zeros(samples)
    transition, inlet = np.array([[1.1, 0.1], [0.0, 0.85]]), np.array([0.0, 1.0])
    for n in range(samples):
        angle[n] = state[0] + 0.01 * rng.standard_normal()
        force[n] = rng.standard_normal() - 2.5 * angle[n] - 0.55 * state[1]
        state = transition @ state + inlet * force[n] + 0.02 * rng.standard_normal(2)
    return force[:, None], angle[:, None]


def test_an_unstable_pole_stays_where_it_is() -> None:
    found = subspace.identify(*pendulum(4000, seed=1), RATE, order=2, horizon=10, stable=False)
    poles = np.sort(np.abs(found.model.poles))
    np.testing.assert_allclose(poles, [0.85, 1.1], rtol=0.02)
    assert found.moved_poles == 0
    assert np.all(np.abs(np.linalg.eigvals(found.model.A - found.model.K @ found.model.C)) < 1)
    fresh = found.compare(*pendulum(2000, seed=2)).fit
    kept = subspace.identify(*pendulum(4000, seed=1), RATE, order=2, horizon=10).compare(*pendulum(2000, seed=2)).fit
    assert fresh.one_step.nrmse[0] > kept.one_step.nrmse[0]
    assert np.isnan(fresh.free_run.nrmse[0])


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(3))
def test_a_ball_on_a_beam_is_two_integrators(seed: int) -> None:
    found = subspace.identify(*ball_and_beam(3000, 10 + seed), RATE, stable=False)
    assert found.core.order <= 8
    nearest = np.sort(np.abs(found.model.poles - 1))[:2]
    assert nearest.max() < 0.1
    assert found.compare(*ball_and_beam(3000, 50 + seed)).fit.one_step.nrmse[0] > 96


def test_a_stable_system_is_the_same_either_way() -> None:
    rng = np.random.default_rng(3)
    drive = rng.standard_normal(1000)
    response = np.zeros(1000)
    for n in range(1, 1000):
        response[n] = 0.9 * response[n - 1] + drive[n - 1] + 0.1 * rng.standard_normal()
    kept, free = (subspace.identify(drive, response, RATE, order=1, horizon=8, stable=each) for each in (True, False))
    np.testing.assert_array_equal(kept.model.A, free.model.A)
    np.testing.assert_array_equal(kept.model.B, free.model.B)
