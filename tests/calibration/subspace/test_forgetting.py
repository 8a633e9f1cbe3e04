"""Predictors that forget where they began."""

import numpy as np
import pytest

from calibration import subspace
from calibration.subspace.forgetting import LEFT, WITHIN, forgetting, slowest
from tests.calibration.resonant_systems import RATE, order_7

TURN = 0.99999 * np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
OUTLET = np.array([[1.0, 0.0, 1.0]])


def radius(transition: np.ndarray, gain: np.ndarray, outlet: np.ndarray) -> float:
    return float(np.abs(np.linalg.eigvals(transition - gain @ outlet)).max())


def test_the_poles_are_moved_that_remember_and_hardly_any_other() -> None:
    transition = np.zeros((3, 3))
    transition[:2, :2], transition[2, 2] = TURN, 0.8
    gain = np.array([[1e-6], [0.0], [0.3]])
    bound = slowest(1000)
    found = forgetting(transition, OUTLET, gain, np.eye(1), bound)
    assert radius(transition, gain, OUTLET) > 0.9999
    assert radius(transition, found, OUTLET) < bound
    assert abs(found[2, 0] - 0.3) < 0.05
    assert np.abs(found[:2]).max() < 0.2


def test_a_gain_that_forgets_is_left_as_it_is() -> None:
    gain = np.array([[0.5]])
    assert forgetting(np.array([[0.9]]), np.eye(1), gain, np.eye(1), slowest(1000)) is gain


def test_a_wrong_first_state_is_gone_within_its_part_of_the_record() -> None:
    assert slowest(1000) ** (WITHIN * 1000) == pytest.approx(LEFT)


def test_a_hum_in_the_record_leaves_no_predictor_that_needs_the_whole_record_to_settle() -> None:
    """Sines without noise of their own are predicted best by a gain of nothing and a first state that was fitted."""
    drive, response = order_7().record(2000, seed=3)
    hum = np.sin(np.outer(np.arange(2000), [0.3, 0.71])).sum(axis=1, keepdims=True)
    found = subspace.identify(drive, response + 0.5 * response.std() * hum, RATE, order=11, horizon=30)
    model = found.model
    assert radius(model.A, model.K, model.C) < slowest(2000)
    late = slice(1000, None)
    deviation = response + 0.5 * response.std() * hum - found.output_offset
    from_zero = (deviation - model.predict(drive - found.input_offset, deviation))[late]
    assert np.std(from_zero) < 1.1 * np.sqrt(model.innovation[0, 0])
