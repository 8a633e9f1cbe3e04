"""What drives a model's states: by the modes' sums, by simulated columns, and by all columns written out."""

import numpy as np
import pytest

from calibration.state_space.model import InnovationModel
from calibration.subspace.modal import modal
from calibration.subspace.modal_regression import regress, responses, sums
from calibration.subspace.regression import Regression, Terms, regress_columns
from calibration.subspace.response import fit_response
from tests.calibration.state_space.test_model import RATE, resonant

MODEL = resonant(order=4)
RNG = np.random.default_rng(5)
DRIVES = [RNG.standard_normal((1500, 2)), RNG.standard_normal((900, 2))]
STATES = [RNG.standard_normal(4), RNG.standard_normal(4)]
LEVEL = np.array([1.0, -2.0, 0.5])
TARGETS = [
    MODEL.simulate(drive, state) + LEVEL + 0.3 * RNG.standard_normal((len(drive), 3))
    for drive, state in zip(DRIVES, STATES, strict=True)
]


def by_modes(terms: Terms) -> Regression:
    """Fit by sums over the modes' responses."""
    modes = modal(MODEL.A)
    return regress(modes, MODEL.C, [sums(modes, *pair) for pair in zip(DRIVES, TARGETS, strict=True)], terms)


def by_columns(terms: Terms) -> Regression:
    """Fit by columns simulated one by one."""
    return regress_columns(MODEL.A, MODEL.C, DRIVES, TARGETS, terms)


@pytest.mark.parametrize("fitted", [by_modes, by_columns])
def test_what_drove_the_states_is_found_up_to_the_noise(fitted: object) -> None:
    found = fitted(Terms(direct=True, constant=True))  # type: ignore[operator]  # one of two functions
    np.testing.assert_allclose(found.inlet, MODEL.B, atol=0.05)
    np.testing.assert_allclose(found.direct, MODEL.D, atol=0.05)
    np.testing.assert_allclose(found.constant, LEVEL, atol=0.05)
    np.testing.assert_allclose(found.states, STATES, atol=0.5)
    assert found.left == pytest.approx(0.09 * 3 * 2400, rel=0.05)


@pytest.mark.parametrize("direct", [True, False])
@pytest.mark.parametrize("constant", [True, False])
def test_both_ways_give_the_same(direct: bool, constant: bool) -> None:
    one, other = by_modes(Terms(direct, constant)), by_columns(Terms(direct, constant))
    np.testing.assert_allclose(one.inlet, other.inlet, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(one.direct, other.direct, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(one.constant, other.constant, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(one.states, other.states, rtol=1e-6, atol=1e-8)
    assert one.left == pytest.approx(other.left, rel=1e-8)
    assert bool(np.any(one.direct)) is direct
    assert bool(np.any(one.constant)) is constant


def test_both_ways_give_the_same_with_real_poles_among_the_pairs() -> None:
    matrix, rng = np.zeros((6, 6)), np.random.default_rng(8)
    matrix[0, 0], matrix[1:5, 1:5], matrix[5, 5] = -0.4, MODEL.A, 0.7
    outlet, terms = rng.standard_normal((3, 6)), Terms(direct=True, constant=True)
    modes = modal(matrix)
    one = regress(modes, outlet, [sums(modes, *pair) for pair in zip(DRIVES, TARGETS, strict=True)], terms)
    other = regress_columns(matrix, outlet, DRIVES, TARGETS, terms)
    np.testing.assert_allclose(one.inlet, other.inlet, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(one.direct, other.direct, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(one.states, other.states, rtol=1e-6, atol=1e-8)


def test_what_is_left_is_what_the_fitted_model_misses() -> None:
    found = by_columns(Terms(direct=True, constant=True))
    fitted = InnovationModel(MODEL.A, found.inlet, MODEL.C, found.direct, MODEL.K, RATE, MODEL.innovation)
    missed = [
        target - found.constant - fitted.simulate(drive, state)
        for drive, target, state in zip(DRIVES, TARGETS, found.states, strict=True)
    ]
    assert found.left == pytest.approx(sum(float(np.sum(each**2)) for each in missed), rel=1e-9)


def test_a_response_by_modes_is_the_free_run() -> None:
    """With a real pole among the pairs."""
    matrix = np.zeros((5, 5))
    matrix[:4, :4], matrix[4, 4] = MODEL.A, 0.7
    rng = np.random.default_rng(6)
    inlet, outlet, state = rng.standard_normal((5, 2)), rng.standard_normal((3, 5)), rng.standard_normal(5)
    model = InnovationModel(matrix, inlet, outlet, np.zeros((3, 2)), np.zeros((5, 3)), RATE, np.eye(3))
    found = responses(modal(matrix), outlet, inlet, DRIVES[0], state)
    np.testing.assert_allclose(found, model.simulate(DRIVES[0], state), rtol=1e-8, atol=1e-9)


def test_the_free_run_is_fitted_right_where_poles_coincide() -> None:
    matrix, outlet, terms = np.array([[0.5, 1.0], [0.0, 0.5]]), np.array([[1.0, 0.3]]), Terms(True, True)
    targets = [target[:, :1] for target in TARGETS]
    found = fit_response(matrix, outlet, DRIVES, targets, terms)
    expected = regress_columns(matrix, outlet, DRIVES, targets, terms)
    np.testing.assert_allclose(found.inlet, expected.inlet, rtol=1e-9)
    assert found.left == pytest.approx(expected.left, rel=1e-9)


def test_poles_that_coincide_make_a_badly_conditioned_basis() -> None:
    assert modal(np.array([[0.5, 1.0], [0.0, 0.5]])).condition > 1e7
    assert modal(MODEL.A).condition < 10
