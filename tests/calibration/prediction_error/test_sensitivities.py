"""Errors of responses: their derivatives against differences, and how far models of many records lie apart."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.prediction_error import refine
from calibration.prediction_error.element import Element
from calibration.prediction_error.local_coordinates import around, free
from calibration.prediction_error.scale import Scale
from calibration.prediction_error.sensitivities import Sensitivities, of_prediction, of_simulation
from calibration.state_space.model import InnovationModel
from tests.calibration.resonant_systems import order_9

FREQUENCY = np.array([3.0, 40.0, 62.0, 96.0, 150.0, 400.0])
STEP = 1e-6
SCALE = Scale(np.array([2.0, 0.5]), np.array([10.0, 0.1]))


def plant() -> InnovationModel:
    rng = np.random.default_rng(4)
    a = np.array([[0.8, 0.5, 0.0], [-0.5, 0.8, 0.0], [0.0, 0.0, 0.9]])
    b, c, k = rng.standard_normal((3, 2)), rng.standard_normal((2, 3)), 0.1 * rng.standard_normal((3, 2))
    return InnovationModel(a, b, c, rng.standard_normal((2, 2)), k, 1000.0, np.eye(2))


def one_at_a_time(found: Sensitivities, number: int) -> Sensitivities:
    """Return those of a fit in which one parameter alone is uncertain, by one."""
    covariance = np.zeros((len(found.a), len(found.a)))
    covariance[number, number] = 1.0
    return replace(found, covariance=covariance)


@pytest.mark.parametrize("is_predictor", [True, False], ids=["prediction", "simulation"])
def test_each_parameter_moves_the_responses_as_differences_say(is_predictor: bool) -> None:
    model = plant()
    inlet = np.hstack([model.B - model.K @ model.D, model.K]) if is_predictor else model.B
    element = Element(model.A - model.K @ model.C if is_predictor else model.A, inlet, model.C)
    if is_predictor:
        element = replace(element, gain_at=2)
    at, _ = around([element], model.D, [[np.zeros(3)]], free)
    count = len(at.steps[0].a) + model.D.size
    found = (of_prediction if is_predictor else of_simulation)(at, np.eye(count), SCALE)
    drive = np.random.default_rng(5).standard_normal((40, 2))

    def moved(step: np.ndarray) -> InnovationModel:
        (each,), d = at.moved(step)
        gain = each.b[:, 2:] if is_predictor else np.zeros((3, 2))
        scaled = replace(model, A=each.system(), B=each.b[:, :2] + gain @ d, C=each.c, D=d, K=gain)
        return SCALE.removed(scaled)

    here = moved(np.zeros(count))
    for number in range(count):
        step = np.zeros(count)
        step[number] = STEP
        high, low = moved(step), moved(-step)
        alone = one_at_a_time(found, number)
        errors = alone.response_errors(here, FREQUENCY)
        gains = [np.abs(each.frequency_response(FREQUENCY)) for each in (high, low)]
        turned = np.angle(high.frequency_response(FREQUENCY) / low.frequency_response(FREQUENCY))
        np.testing.assert_allclose(errors.magnitude, np.abs(gains[0] - gains[1]) / (2 * STEP), rtol=1e-4, atol=1e-5)
        np.testing.assert_allclose(errors.phase, np.abs(turned) / (2 * STEP), rtol=1e-4, atol=1e-6)
        runs = np.abs(high.simulate(drive) - low.simulate(drive)) / (2 * STEP)
        np.testing.assert_allclose(alone.simulation_errors(here, drive), runs, rtol=1e-4, atol=1e-5)


@pytest.mark.slow
def test_models_of_many_records_lie_as_far_apart_as_one_of_them_says() -> None:
    system, drive = order_9(), np.random.default_rng(6).standard_normal((60, 1))
    found = [refine(system.model, *system.record(3000, seed=200 + seed)) for seed in range(24)]
    said, model = found[0].sensitivities, found[0].model
    errors = said.response_errors(model, FREQUENCY)
    responses = np.array([each.model.frequency_response(FREQUENCY) for each in found])
    true = system.model.frequency_response(FREQUENCY)
    sizes = {
        "magnitude": (np.abs(responses) - np.abs(true), errors.magnitude),
        "phase": (np.angle(responses / true), errors.phase),
        "free run": (
            np.array([each.model.simulate(drive) for each in found]) - system.model.simulate(drive),
            said.simulation_errors(model, drive),
        ),
    }
    for name, (off, stated) in sizes.items():
        kept = stated > 0  # D is not known to move what comes before anything was driven
        ratio = np.sqrt(np.mean(off[:, kept] ** 2, axis=0)) / stated[kept]
        assert 0.85 < np.sqrt(np.mean(ratio**2)) < 1.15, name
