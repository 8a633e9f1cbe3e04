"""Records of a closed loop: that it is found, and that the model is of the plant and not of its controller."""

from functools import cache

import numpy as np
import pytest
from numba import njit

from calibration import subspace
from calibration.state_space import InnovationModel
from calibration.subspace.feedback import Feedback, feedback
from calibration.subspace.signals import signals

FREQUENCY = np.linspace(1e-3, 0.45, 200)
POLES, NOISE_POLES = np.poly([0.9 * np.exp(0.4j), 0.9 * np.exp(-0.4j), 0.7]).real, np.poly([0.5, 0.3, -0.2]).real
ZEROS = np.array([0.0, 0.05, 0.12, 0.03])


@njit
def _run(poles, zeros, noise_poles, asked, noise, proportional, integral):  # type: ignore[no-untyped-def]
    response, drive, sum_of = np.zeros(len(asked)), np.zeros(len(asked)), 0.0
    for n in range(3, len(asked)):
        response[n] = noise[n]
        for lag in range(1, 4):
            response[n] += (
                zeros[lag] * drive[n - lag] - poles[lag] * response[n - lag] + noise_poles[lag] * noise[n - lag]
            )
        sum_of -= integral * response[n]
        drive[n] = 0.5 * asked[n] - proportional * response[n] + sum_of
    return drive, response


@cache
def record(samples: int, seed: int, noise: float, gain: float) -> tuple[np.ndarray, np.ndarray]:
    """Return drive and response, (samples,), of a plant of three states under PI control of a gain, or of none."""
    rng = np.random.default_rng(seed)
    asked, heard = rng.standard_normal((2, samples))
    drive, response = _run(POLES, ZEROS, NOISE_POLES, asked, noise * heard, 0.08 * gain, 0.004 * gain)
    return drive, response


def off(model: InnovationModel) -> float:
    """Return by how much of the plant's response a model's is off."""
    turn = np.exp(-2j * np.pi * FREQUENCY)
    plant = np.polyval(ZEROS[::-1], turn) / np.polyval(POLES[::-1], turn)
    found = model.frequency_response(FREQUENCY)[:, 0, 0]
    return float(np.linalg.norm(found - plant) / np.linalg.norm(plant))


def fed_back(drive: np.ndarray, response: np.ndarray) -> Feedback:
    data = signals([drive.reshape(len(drive), -1)], [response.reshape(len(response), -1)], has_mean=True)
    return feedback(data.drives, data.responses)


def test_in_a_closed_loop_the_plant_is_found_and_its_controller_is_not_taken_for_it() -> None:
    drive, response = record(8000, 1, 0.5, 1.0)
    found = subspace.identify(drive, response, 1.0, order=3, horizon=30)
    assert found.method == "pbsid"
    assert found.refined is not None
    assert off(found.model) < 0.15
    assert "u1 follows from the outputs" in found.summary()
    by_hand = subspace.identify(drive, response, 1.0, order=3, horizon=30, method="moesp")
    assert off(by_hand.model) > 0.8
    assert "this method takes part of the controller for the plant" in by_hand.summary()


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(6))
def test_order_and_horizon_are_found_in_a_closed_loop(seed: int) -> None:
    found = subspace.identify(*record(20_000, seed, 0.2, 1.0), 1.0)
    assert found.method == "pbsid"
    assert found.core.order == 3
    assert off(found.model) < 0.05
    assert np.isfinite(found.pole_errors.frequency).all()


@pytest.mark.parametrize("noise", [0.01, 0.5])
def test_without_a_loop_none_is_found(noise: float) -> None:
    drive, response = record(5000, 2, noise, 0.0)
    assert fed_back(drive, response).share.max() < 0.01
    assert subspace.identify(drive, response, 1.0, order=3, horizon=30).method == "moesp"


def test_without_noise_a_loop_does_no_harm_and_a_direct_term_is_no_loop() -> None:
    drive, response = record(5000, 3, 1e-4, 1.0)
    assert not fed_back(drive, response).inputs
    drive, response = record(5000, 4, 0.5, 0.0)
    assert not fed_back(drive, response + drive).inputs


def test_what_is_filtered_without_delay_is_no_loop() -> None:
    rng = np.random.default_rng(5)
    drive = np.convolve(rng.standard_normal(5100), np.hanning(101), "same")[50:-50]
    response = np.convolve(drive, [0.0, 0.5, 0.3, 0.1])[: len(drive)] + 1e-5 * rng.standard_normal(len(drive))
    assert not fed_back(drive, response).inputs


def test_short_records_and_inputs_that_their_own_past_tells_show_none() -> None:
    drive, response = record(5000, 6, 0.5, 1.0)
    assert not fed_back(drive[:150], response[:150]).inputs
    sine = np.sin(0.3 * np.arange(5000))
    assert not fed_back(sine, sine + 0.1 * np.random.default_rng(7).standard_normal(5000)).inputs


def test_of_several_inputs_the_one_in_the_loop_is_named() -> None:
    drive, response = record(6000, 8, 0.5, 1.0)
    free = np.random.default_rng(9).standard_normal(6000)
    assert fed_back(np.column_stack([free, drive]), response).inputs == (1,)
