"""The Riccati equation of a stable predictor, solved by doubling."""

import numpy as np
import pytest
from scipy.linalg import LinAlgError, solve_discrete_are

from calibration.subspace.riccati import filter_covariance


@pytest.mark.parametrize(("order", "outputs", "radius"), [(1, 1, 0.9), (7, 2, 0.999), (40, 3, 0.99)])
def test_it_is_the_solution_that_the_pencil_gives(order: int, outputs: int, radius: float) -> None:
    random = np.random.default_rng(order)
    transition = random.normal(size=(order, order))
    transition *= radius / np.abs(np.linalg.eigvals(transition)).max()
    outlet, root = random.normal(size=(outputs, order)), random.normal(size=(order, 2))
    noise = np.diag(random.uniform(0.1, 2.0, outputs))
    found = filter_covariance(transition, outlet, root @ root.T, noise)
    right = solve_discrete_are(transition.T, outlet.T, root @ root.T, noise)
    np.testing.assert_allclose(found, right, atol=1e-9 * np.abs(right).max())


def test_a_mode_that_hardly_decays_and_is_hardly_driven_is_found_to_its_own_accuracy() -> None:
    pole, process = 1.0 - 1e-7, 1e-12
    found = filter_covariance(np.array([[pole]]), np.eye(1), np.array([[process]]), np.eye(1))[0, 0]
    assert found == pytest.approx(pole**2 * found / (found + 1.0) + process, rel=1e-9)
    assert found == pytest.approx(9.05e-7, rel=0.01)  # p^2 + (1 - a^2 - q) p - q = 0


def test_a_small_state_beside_a_large_one_is_found_to_its_own_accuracy() -> None:
    transition, outlet = np.diag([0.0, 1.0 - 1e-9]), np.array([[0.0, 1e-3]])
    found = filter_covariance(transition, outlet, np.diag([1.0, 1e-16]), np.eye(1))
    assert found[1, 1] == pytest.approx(5.0e-8, rel=0.1)


def test_where_an_output_has_hardly_any_noise_it_is_as_right_as_the_pencil() -> None:
    random = np.random.default_rng(5)
    transition = random.normal(size=(8, 8))
    transition *= 0.95 / np.abs(np.linalg.eigvals(transition)).max()
    outlet, noise, root = random.normal(size=(2, 8)), np.diag([1.0, 1e-12]), random.normal(size=(8, 8))
    found = filter_covariance(transition, outlet, root @ root.T, noise)
    right = solve_discrete_are(transition.T, outlet.T, root @ root.T, noise)
    np.testing.assert_allclose(found, right, atol=1e-8 * np.abs(right).max())


def test_an_unstable_one_that_nothing_is_measured_of_has_none() -> None:
    with pytest.raises(LinAlgError), np.errstate(all="ignore"):
        filter_covariance(np.array([[2.0]]), np.zeros((1, 1)), np.eye(1), np.eye(1))
