"""Sensors that drift: what is so slow is taken out where that is wanted."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration import subspace
from calibration.subspace.drift import without_slow

SAMPLES = 4000
TIME = np.arange(SAMPLES) / SAMPLES
SLOW = 3.0 * TIME + 2.0 * np.sin(2 * np.pi * 1.7 * TIME)
NUMERATOR, DENOMINATOR = [0.0, 0.5, 0.2], [1.0, -1.5, 0.8]
AT = np.geomspace(5.0, 480.0, 60)


def missed(detrend: subspace.Detrend, wandering: float) -> float:
    """Return how much of a resonance is missed, from a record with noise 30 dB below and a drifting sensor."""
    random = np.random.default_rng(2)
    drive = random.standard_normal(SAMPLES)
    response = lfilter(NUMERATOR, DENOMINATOR, drive)
    response += response.std() * (wandering * SLOW + 0.03 * random.standard_normal(SAMPLES))
    found = subspace.identify(drive, response, 1000.0, order=2, horizon=20, delay=0, detrend=detrend)
    unit = np.exp(-2j * np.pi * AT / 1000.0)
    right = np.polyval(NUMERATOR[::-1], unit) / np.polyval(DENOMINATOR[::-1], unit)
    return float(np.linalg.norm(found.model.frequency_response(AT)[:, 0, 0] - right) / np.linalg.norm(right))


def test_slopes_and_swings_of_a_few_periods_go_and_faster_ones_stay() -> None:
    fast = np.sin(2 * np.pi * 8 * TIME)
    left = without_slow(np.stack([SLOW, 5 + 3 * TIME, fast], axis=1))
    assert left[:, 0].std() < 0.04 * SLOW.std()
    np.testing.assert_allclose(left[:, 1], 0.0, atol=1e-9)
    assert (left[:, 2] @ fast) / (fast @ fast) > 0.9


def test_a_short_record_loses_its_line_alone() -> None:
    short = np.random.default_rng(1).standard_normal((100, 1))
    time = np.arange(100)
    np.testing.assert_allclose(
        without_slow(short)[:, 0], short[:, 0] - np.polyval(np.polyfit(time, short[:, 0], 1), time)
    )


def test_without_what_is_slow_a_sensor_that_drifts_costs_nothing() -> None:
    assert missed("slow", 1.0) < max(0.01, 2 * missed("mean", 0.0))
    assert missed("mean", 1.0) > 5 * missed("slow", 1.0)


def test_another_word_is_refused() -> None:
    with pytest.raises(ValueError, match="detrend is 'quadratic', must be one of mean, record, linear, slow, none"):
        missed("quadratic", 0.0)  # type: ignore[arg-type]  # what a person writes
