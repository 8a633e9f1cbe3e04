"""Dead time where something else stands in its way: a loop, no direct term, gaps, inputs that are held."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration import subspace

LATE = 11
"""Samples until a first order hears of its input."""


def in_a_loop(seed: int, noise: float, samples: int = 6000) -> tuple[np.ndarray, np.ndarray]:
    """Return a record of that plant under PI control that answers a sample late."""
    random = np.random.default_rng(seed)
    wanted = np.repeat(random.standard_normal(samples // 50), 50)
    u, y, state, integral = np.zeros(samples + 1), np.zeros(samples), 0.0, 0.0
    for k in range(samples):
        state = 0.8 * state + 0.2 * u[k - LATE] * (k >= LATE)
        y[k] = state + noise * random.standard_normal()
        integral += 0.01 * (wanted[k] - y[k])
        u[k + 1] = 0.3 * (wanted[k] - y[k]) + integral
    return u[:-1], y


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_in_a_loop_no_coefficient_of_the_response_is_lost(seed: int) -> None:
    found = subspace.identify(*in_a_loop(seed, 0.05), 1.0)
    assert found.method == "pbsid"
    assert found.delays == (LATE - 1,)
    u = np.random.default_rng(99).standard_normal(3000)
    y = lfilter([0.2], [1, -0.8], np.concatenate([np.zeros(LATE), u])[:3000])
    assert found.compare(u, y).fit.free_run.nrmse[0] > 95


def test_without_a_direct_term_the_first_lag_that_is_heard_is_the_model_s_first() -> None:
    random = np.random.default_rng(1)
    u = random.standard_normal(4000)
    y = lfilter([0, 0.5], [1, -0.5], np.concatenate([np.zeros(10), u])[:4000]) + 0.05 * random.standard_normal(4000)
    found = subspace.identify(u, y, 1.0, direct=False)
    assert found.delays == (10,)
    assert found.model.simulate(np.eye(13, 1))[10:].ravel() == pytest.approx([0.0, 0.5, 0.25], abs=0.02)


def test_a_gap_near_the_beginning_hides_no_dead_time() -> None:
    random = np.random.default_rng(1)
    u = random.standard_normal(4000)
    y = lfilter(np.r_[np.zeros(200), 0.3], [1, -0.7], u) + 0.1 * random.standard_normal(4000)
    y[250] = np.nan
    with pytest.warns(UserWarning, match="missing|1 record of at most 400 samples, twice the dead time, left out"):
        found = subspace.identify(u, y, 1.0)
    assert found.delays == (200,)
    assert found.fit.free_run.nrmse[0] > 75
    with pytest.warns(UserWarning, match="missing|left out"):
        given = subspace.identify(u, y, 1.0, delay=200)
    np.testing.assert_allclose(given.model.poles[:1], found.model.poles[:1])
    y[250] = 0.0
    with pytest.raises(ValueError, match="must be 0 to 1999 samples, half of the longest record"):
        subspace.identify(u, y, 1.0, delay=2000)


@pytest.mark.parametrize("late", [300, pytest.param(800, marks=pytest.mark.slow)])
def test_a_slow_plant_whose_input_is_held_is_known_to_be_late(late: int) -> None:
    random, pole = np.random.default_rng(1), np.exp(-1 / 200)
    u = np.repeat(random.standard_normal(60), 100)
    y = lfilter([0, 1 - pole], [1, -pole], np.concatenate([np.zeros(late), u])[:6000]) + 0.02 * random.standard_normal(
        6000
    )
    found = subspace.identify(u, y, 1.0)
    assert abs(found.delays[0] - late) < 10
    assert found.core.order == 1
    assert found.fit.free_run.nrmse[0] > 90


def test_what_is_heard_of_by_all_lags_together_is_not_called_unheard() -> None:
    random, pole = np.random.default_rng(1), np.exp(-1 / 1000)
    u = np.repeat(random.standard_normal(60), 100)
    y = lfilter([0, 1 - pole], [1, -pole], u) + 0.02 * random.standard_normal(6000)
    assert "no output hears" not in str(subspace.examine(u, y))
    assert "no output hears" not in subspace.identify(u, y, 1.0).summary()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_double_integrator_s_input_of_rest_is_found_though_its_records_have_a_mean(seed: int) -> None:
    random = np.random.default_rng(seed)
    u = np.repeat(random.standard_normal(200), 10) + 0.5
    y = lfilter([0, 0.005, 0.005], [1, -2, 1], u) + 0.05 * random.standard_normal(2000)
    found = subspace.identify(u, y, 10.0, stable=False)
    assert found.input_offset[0] == pytest.approx(0.0, abs=5e-3)
    left = found.residuals()[0]
    assert abs(left.mean()) < 0.05 * left.std()


def test_stretches_that_any_first_state_fits_are_no_witness() -> None:
    random = np.random.default_rng(0)
    u = random.standard_normal(1500)
    found = subspace.identify(
        u, lfilter([0, 1], [1, -1.5, 0.8], u) + 0.05 * random.standard_normal(1500), 10.0, order=2
    )
    noise = 5 * random.standard_normal(1500)
    noise[::3] = np.nan
    with pytest.raises(ValueError, match="between them there is no stretch of 16 samples"):
        found.compare(u, noise)
    with pytest.raises(ValueError, match="a record has 3 samples, must have 16"):
        found.compare(u[:3], u[:3])
