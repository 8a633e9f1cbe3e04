"""Fits of hysteresis models: to models, to the simulated stage and to a stack that others measured."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.fit_measures import nrmse
from calibration.hysteresis import Settings, fit
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from stagectl.stage.hysteresis import HysteresisModel, invert, respond
from tests.firmware_sim.stage_runs import run
from tests.shared_data import shared

PICMA_RATE = 200.0
TRUE = HysteresisModel(
    0.0,
    100.0,
    np.array([1e-5, 1e-5, 5e-7, -3e-7]),
    np.array([-0.1, 0.05]),
    np.array([0.1, 0.0]),
    (np.arange(8) + 0.5) / 8,
    np.array([3, 2, 2, 1, 1, 1, 0.5, 0.5]) * 1e-6,
    500.0,
    delay=1,
)


def _swept(samples: int) -> np.ndarray:
    """Return cycles of 0.5, 2 and 7 Hz that grow, shape (samples,), V, 0 to 100."""
    time = np.arange(samples) / 500.0
    wave = np.sin(2 * np.pi * 0.5 * time) + 0.3 * np.sin(2 * np.pi * 2 * time) + 0.1 * np.sin(2 * np.pi * 7 * time)
    wave *= np.minimum(1.0, 0.2 + time / 4)
    return 100 * (wave - wave.min()) / np.ptp(wave)


def _fit(measured: np.ndarray, modelled: np.ndarray) -> float:
    return float(nrmse(measured[:, None], modelled[:, None])[0])


def test_what_a_model_makes_is_fitted_to_its_last_digits() -> None:
    """99.9 % over what was not fitted; its envelopes are found."""
    voltage = _swept(4_000)
    response = respond(TRUE, voltage)
    found = fit(voltage, response, 500.0, slice(0, 2_500), Settings(8, 1))
    assert _fit(response[2_500:], found.modelled[2_500:]) > 99.9
    np.testing.assert_allclose([*found.model.rising, *found.model.falling], [-0.1, 0.05, 0.1, 0.0], atol=0.04)


@pytest.mark.slow
def test_a_lag_is_told_from_the_loops_where_a_record_has_several_rates() -> None:
    voltage = _swept(3_000)
    response = respond(replace(TRUE, lag=0.02), voltage)
    found = fit(voltage, response, 500.0, None, Settings(8, 1, with_lag=True))
    assert found.model.lag == pytest.approx(0.02, rel=0.1)
    assert _fit(response, found.modelled) > 99.8


def _picma(name: str) -> np.ndarray:
    """Return a record of the PICMA stack, shape (samples, columns), V and um."""
    return np.loadtxt(shared(f"piezo/{name}"))


def test_a_picma_stack_is_fitted_to_98_7_percent_of_what_was_held_back() -> None:
    """Fitted to rows 1000 to 4000, judged on 4000 to 8000; the shared notes' own best is 98.22 %."""
    record = _picma("Model_Vi_Do.dat")
    voltage, moved = record[:, 0], 1e-6 * record[:, 4]
    found = fit(voltage, moved, PICMA_RATE, slice(1_000, 4_000))
    assert _fit(moved[4_000:8_000], found.modelled[4_000:8_000]) > 98.7


@pytest.mark.slow
def test_the_inverse_makes_less_than_the_published_error_on_a_model_of_another_record() -> None:
    """0.58 um rms published with an inverse, 1.68 without [Aye and Ang, ICSTSD 2018]; here below 0.35.

    The inverse is of the model fitted to the Model record.  What it would do is computed by a model of its own: 30
    plays and a lag, fitted to rows 200 to 11000 of the Test record, which ends before the window that is judged.  That
    model meets what was measured in the window to 0.16 um, and gives the published inverse's own voltage 0.59 um.
    """
    record, test = _picma("Model_Vi_Do.dat"), _picma("Test_Vi_Do_Di.dat")
    inverted = fit(record[:, 0], 1e-6 * record[:, 4], PICMA_RATE, slice(1_000, 8_000)).model
    voltage, moved, wanted = test[:, 0], 1e-6 * test[:, 4], 1e-6 * test[:, 8]
    stack = fit(voltage, moved, PICMA_RATE, slice(200, 11_000), Settings(30, 1, with_lag=True)).model
    judged, late = slice(11_151, 12_151), slice(11_152, 12_152)

    def error(answer: np.ndarray, reference: np.ndarray) -> float:
        return float(1e6 * np.std(answer[late] - reference))  # the sensor's zero is anywhere

    assert error(respond(stack, voltage), moved[late]) < 0.18
    assert error(respond(stack, voltage), wanted[judged]) == pytest.approx(0.58, abs=0.04)
    rest = respond(inverted, np.array([1.83]))[0]
    ours = invert(inverted, wanted + rest, start=1.83)
    assert error(respond(stack, ours, start=1.83), wanted[judged]) < 0.35


def test_the_inverse_straightens_the_simulated_stack() -> None:
    """Departures of 20 % of the span become less than 2.5; the plant is no model fitted here, and it creeps."""
    rate, every = 10_000.0, 20
    time = np.arange(60_000) / rate
    voltage = np.repeat((500 - 450 * np.cos(2 * np.pi * time) * (1 - 0.6 * time / 6))[:, None], 3, axis=1)
    extension, _, _ = run(PiezoStagePlant(rate), voltage)
    found = fit(voltage[::every, 0], extension[::every, 0], rate / every, slice(500, None), Settings(delay=0))
    asked = 500 - 400 * np.cos(2 * np.pi * time)
    low, high = found.model.span
    model = found.model
    wanted = low + (high - low) * (asked - model.low) / (model.high - model.low)
    straight = np.repeat(invert(model, wanted, start=0.0)[:, None], 3, axis=1)
    answer, _, _ = run(PiezoStagePlant(rate), straight)
    plain, _, _ = run(PiezoStagePlant(rate), np.repeat(asked[:, None], 3, axis=1))

    def residual(moved: np.ndarray) -> float:
        line = np.polyfit(asked[20_000:], moved[20_000:, 0], 1)
        return float(np.ptp(moved[20_000:, 0] - np.polyval(line, asked[20_000:])) / np.ptp(moved[20_000:, 0]))

    assert residual(plain) > 0.15
    assert residual(answer) < 0.025


@pytest.mark.parametrize(
    ("voltage", "response", "words"),
    [
        (np.zeros(500), np.arange(500.0), "does not move"),
        (np.arange(500.0), np.arange(499.0), "must be alike"),
        (np.arange(500.0), np.full(500, np.nan), "not finite"),
        (np.arange(50.0), np.arange(50.0), "50 samples to fit, must be >= 106 for 16 plays"),
    ],
)
def test_a_record_that_cannot_be_fitted_is_refused(voltage: np.ndarray, response: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        fit(voltage, response, 100.0)
