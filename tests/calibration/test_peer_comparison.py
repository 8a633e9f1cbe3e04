"""The comparison with other packages: what it takes from them, and what it says where they fail."""

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmarks.identification_methods import companion
from benchmarks.identification_peers import damping_errors, fits
from benchmarks.identification_targets import Row
from benchmarks.measured_process import Job, Outcome, measured
from tests.calibration.resonant_systems import order_7

NOTHING = np.zeros((0, 2)), np.zeros((0, 3))


def test_an_armax_polynomial_becomes_the_state_space_that_filters_alike() -> None:
    rng = np.random.default_rng(1)
    a, b, c = np.array([1.0, -1.5, 0.8]), np.array([0.0, 0.5, 0.3, 0.1]), np.array([1.0, 0.4, 0.1])
    drive, noise = rng.standard_normal((2, 4000))
    response = lfilter(b, a, drive) + 0.1 * lfilter(c, a, noise)
    free, step = fits(companion(a, b, c), drive[:, None], response[:, None])
    spread = np.std(response)
    assert free == pytest.approx(100 * (1 - 0.1 * np.std(lfilter(c, a, noise)) / spread), abs=0.1)
    assert step == pytest.approx(100 * (1 - 0.1 * np.std(noise) / spread), abs=0.1)


def test_a_model_that_is_not_stable_has_no_fit() -> None:
    growing = companion(np.array([1.0, -1.1]), np.array([0.0, 1.0]), np.array([1.0, 0.0]))
    free, _ = fits(growing, np.ones((50, 1)), np.ones((50, 1)))
    assert np.isnan(free)


def test_the_truth_has_no_damping_error_and_one_slower_pole_has_its_own() -> None:
    truth = order_7().model
    assert np.allclose(damping_errors({"A": truth.A}, truth), 0, atol=1e-8)
    poles, shapes = np.linalg.eig(truth.A)
    first = np.abs(np.angle(poles)) < 2 * np.pi * 70 / 1000
    pole = np.where(first & (poles.imag != 0), poles * np.abs(poles) ** 0.5, poles)
    moved = (shapes @ np.diag(pole) @ np.linalg.inv(shapes)).real
    assert np.allclose(damping_errors({"A": moved}, truth), [50, 0, 0], atol=0.1)


@pytest.mark.slow
def test_a_method_runs_in_a_process_of_its_own_and_is_measured_there() -> None:
    drive, response = order_7().record(1000, seed=1)
    done = measured(Job("ours", 7, 20, drive[None], response[None]))
    assert done.failure == ""
    assert done.models[0]["A"].shape == (7, 7)
    assert done.orders == [7]
    assert 0 < done.cpu
    assert 0 < done.wall
    assert 20 < done.before < done.peak < 2000


def test_what_fails_and_what_is_not_installed_are_rows_that_say_so() -> None:
    short = np.zeros((1, 100, 1))
    failed = measured(Job("ours", 7, 20, short, short))
    assert failed.failure == "ValueError: input 1 never changes, nothing can be identified from it"
    row = Row(7, 100, 20, "ours", failed, *NOTHING)
    assert row.line().startswith("| ours | fails: ValueError: input 1 never changes")
    absent = Outcome([], [], failure="ModuleNotFoundError: No module named 'ctrlsys'")
    assert "| skipped: ModuleNotFoundError" in Row(7, 100, 20, "SLICOT", absent, *NOTHING).line()
