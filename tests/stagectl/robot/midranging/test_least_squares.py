"""Recursive least squares: against its equations, and what it does not listen to."""

import math

import numpy as np
import pytest

from stagectl.robot.midranging import least_squares_kernel as kernel
from stagectl.robot.midranging.least_squares import LeastSquares

RATE = 250.0


def _loop(inputs: np.ndarray, order: int, noise: float = 0.0, gain: float = 1.0) -> np.ndarray:
    """Simulate y_k = 0.96 y_{k-1} + ... with zeros beyond the first order."""
    outputs = np.zeros(len(inputs) + 1)
    for n, value in enumerate(inputs):
        outputs[n + 1] = outputs[n] + 0.04 * gain * (value - outputs[n])
    return outputs[:-1] + noise * np.random.default_rng(order).standard_normal(len(inputs))


def _estimate(settings: LeastSquares, inputs: np.ndarray, outputs: np.ndarray, start: list[float]) -> np.ndarray:
    """Return the estimator's record after every sample, shape (samples,)."""
    record = settings.packed(np.array(start), RATE)
    kept = []
    for value, output in zip(inputs, outputs, strict=True):
        kernel.observe(record, len(start) // 2, output)
        kernel.apply(record, value)
        kept.append(record.copy())
    return np.array(kept)


def _steps(count: int = 2000) -> np.ndarray:
    return np.where(np.arange(count) // 250 % 2, -1e-3, 1e-3)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_it_is_3_4(order: int) -> None:
    inputs = np.random.default_rng(1).standard_normal(300) * 1e-3
    outputs = _loop(inputs, order, noise=1e-5)
    settings, start = LeastSquares(forgetting=0.98, noise=1e-5, deviation=10.0), [0.5, 0.0, 0.0][:order] + [0.1] * order
    got = _estimate(settings, inputs, outputs, start)[-1]
    estimate, covariance = np.array(start), np.eye(2 * order) * (10.0 / 1e-5) ** 2
    past_y, past_w = np.zeros(order), np.zeros(order)
    for value, output in zip(inputs, outputs, strict=True):
        regressors = np.concatenate((past_y, past_w))
        gain = covariance @ regressors / (0.98 + regressors @ covariance @ regressors)
        estimate = estimate + gain * (output - regressors @ estimate)
        covariance = (covariance - np.outer(gain, regressors) @ covariance) / 0.98
        covariance *= min(1.0, 2 * order * (10.0 / 1e-5) ** 2 / np.trace(covariance))
        past_y, past_w = np.array([output, *past_y[:-1]]), np.array([value, *past_w[:-1]])
    np.testing.assert_allclose(got["estimate"][: 2 * order], estimate, rtol=1e-5, atol=1e-7)


def test_a_wrong_first_guess_is_forgotten() -> None:
    inputs = _steps()
    got = _estimate(LeastSquares(), inputs, _loop(inputs, 1), [0.8, 0.2])[-1]
    np.testing.assert_allclose(got["estimate"][:2], (0.96, 0.04), rtol=1e-6)


def _covariance(record: np.void, order: int) -> np.ndarray:
    """Return the covariance from its factors, shape (2 order, 2 order)."""
    factors = record["factors"][: 2 * order, : 2 * order]
    upper = np.triu(factors, 1) + np.eye(2 * order)
    return upper @ np.diag(np.diag(factors)) @ upper.T


def test_the_covariance_stays_bounded_while_nothing_moves() -> None:
    settings = LeastSquares(forgetting=0.9)
    got = _estimate(settings, np.zeros(2000), np.zeros(2000), [0.96, 0.04])
    most = 2.0 * settings.packed(np.zeros(2), RATE)["start"] * (1.0 + 1e-12)
    assert max(np.trace(_covariance(record, 1)) for record in got[::50]) <= most


def test_the_covariance_stays_positive_where_parameters_cannot_be_told_apart() -> None:
    """A loop of first order estimated as one of third, without noise, with a start 10^5 times what is right."""
    inputs = _steps(20_000)
    settings = LeastSquares(forgetting=0.98, noise=1e-9, deviation=100.0)
    got = _estimate(settings, inputs, _loop(inputs, 1), [0.9, 0.0, 0.0, 0.1, 0.0, 0.0])
    assert (np.diagonal(got["factors"], axis1=1, axis2=2) > 0.0).all()
    assert all(np.isfinite(got[name]).all() for name in ("estimate", "factors", "alarm"))


def test_smoothing_takes_away_the_bias_of_noise() -> None:
    inputs = 5.0 * _steps(10_000)
    outputs = _loop(inputs, 1, noise=0.3e-3)
    plain = _estimate(LeastSquares(forgetting=1.0, noise=0.3e-3), inputs, outputs, [0.96, 0.04])[-1]
    smooth = _estimate(LeastSquares(forgetting=1.0, noise=0.3e-3, smoothing=0.1), inputs, outputs, [0.96, 0.04])[-1]
    assert abs(plain["estimate"][1] / 0.04 - 1.0) > 0.05
    assert abs(smooth["estimate"][1] / 0.04 - 1.0) < 0.02


def test_a_closed_gate_keeps_noise_out() -> None:
    inputs = np.concatenate((_steps(), np.zeros(4000))) + 2e-5 * np.random.default_rng(3).standard_normal(6000)
    outputs = _loop(inputs, 1, noise=2e-5)
    gated = LeastSquares(forgetting=0.98, noise=2e-5, smoothing=0.1, gate=3.0)
    kept = _estimate(gated, inputs, outputs, [0.96, 0.04])
    open_ = _estimate(LeastSquares(forgetting=0.98, noise=2e-5, smoothing=0.1), inputs, outputs, [0.96, 0.04])
    assert kept["updates"][3000] == kept["updates"][-1]
    assert abs(kept["estimate"][-1, 1] / 0.04 - 1.0) < 0.05
    assert abs(open_["estimate"][3000:, 1] / 0.04 - 1.0).max() > 0.3


def test_a_change_rings_the_alarm_once_and_is_learnt_within_a_step() -> None:
    inputs = _steps(4000)
    outputs = np.zeros(4000)
    for n in range(3999):
        outputs[n + 1] = outputs[n] + 0.04 * (1.5 if n >= 2000 else 1.0) * (inputs[n] - outputs[n])
    outputs += 2e-5 * np.random.default_rng(4).standard_normal(4000)
    rings = LeastSquares(noise=2e-5, smoothing=0.1, gate=3.0, alarm=True)
    heard = _estimate(rings, inputs, outputs, [0.96, 0.04])
    unheard = _estimate(LeastSquares(noise=2e-5, smoothing=0.1, gate=3.0), inputs, outputs, [0.96, 0.04])
    assert heard["resets"][1999] == 0
    assert 1 <= heard["resets"][-1] <= 2
    assert abs(heard["estimate"][2250, 1] / 0.06 - 1.0) < 0.05
    assert abs(unheard["estimate"][2250, 1] / 0.06 - 1.0) > 0.1


@pytest.mark.parametrize(("outliers", "rings"), [(1, False), (4, True)])
def test_an_outlier_does_not_ring_and_several_do(outliers: int, rings: bool) -> None:
    """Smoothed with the loop's own pole, an outlier of the sensor spoils one residual."""
    inputs = 1e-3 * np.sin(0.1 * np.arange(1000))
    settings = LeastSquares(noise=1e-6, smoothing=-0.004 / math.log(0.96), alarm=True)
    outputs = _loop(inputs, 1, noise=1e-6)
    outputs[900 : 900 + outliers] += 0.1e-3
    got = _estimate(settings, inputs, outputs, [0.96, 0.04])[-1]
    assert (got["resets"] > 0) == rings


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"forgetting": 0.0}, r"forgetting is 0\.0, must be > 0 and at most 1"),
        ({"forgetting": math.nan}, r"forgetting is nan"),
        ({"noise": 0.0}, r"noise is 0\.0 m, must be finite and > 0"),
        ({"deviation": math.inf}, r"deviation is inf, must be finite and > 0"),
        ({"smoothing": -1.0}, r"smoothing is -1\.0 s, must be finite and >= 0"),
        ({"gate": 3.0}, r"gate is 3\.0, must be 0 where smoothing is 0 s"),
    ],
)
def test_a_wrong_setting_is_refused_by_name(wrong: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LeastSquares(**wrong)


def test_an_alarm_that_rings_again_and_again_gets_deafer_to_a_bound() -> None:
    """A loop of first order cannot have the mode that rings here: no start anew helps."""
    inputs = np.random.default_rng(3).standard_normal(4000) * 1e-3
    outputs = _loop(inputs, 1) + 2e-4 * np.sin(0.6 * np.arange(4000))
    record = LeastSquares(noise=1e-6, smoothing=0.1, alarm=True).packed(np.array([0.96, 0.04]), RATE)
    record["relative"], record["most"] = 1e-4, 4e-4
    resets = []
    for value, output in zip(inputs, outputs, strict=True):
        kernel.observe(record, 1, output)
        kernel.apply(record, value)
        resets.append(int(record["resets"]))
    assert resets[-1] >= 3
    assert record["relative"] == 4e-4
