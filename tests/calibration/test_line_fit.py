import numpy as np
import pytest
from scipy.signal.windows import tukey

from calibration.line_fit import LineEstimator, background

RATE, FRAMES = 2756.25, 1378
TIME = np.arange(FRAMES) / RATE
WINDOW = tukey(FRAMES, 0.5, sym=False)


def sine(amplitude: complex, frequency: float) -> np.ndarray:
    return (amplitude * np.exp(2j * np.pi * frequency * TIME)).real


def test_it_is_the_windowed_dft_where_the_tones_are_orthogonal() -> None:
    signal = np.random.default_rng(1).standard_normal((FRAMES, 1))
    tone = 200 * RATE / FRAMES
    transformed = 2 / WINDOW.sum() * (WINDOW * np.exp(-2j * np.pi * tone * TIME)) @ signal
    found = LineEstimator(WINDOW, RATE, tone, np.zeros(0)).fit(signal)
    assert found.amplitude == pytest.approx(transformed, rel=1e-3)


def test_a_preload_60_db_above_the_tone_does_not_leak_into_it_as_it_does_in_the_windowed_dft() -> None:
    tone, preload, weak = 133.0, 61.0, 1e-3 * np.exp(0.7j)
    harmonics = preload * np.arange(1, 11)
    signal = sine(weak, tone) + sum(sine(1.0 / k**2 * np.exp(1j * k), f) for k, f in enumerate(harmonics, start=1))
    plain = LineEstimator(WINDOW, RATE, tone, np.zeros(0)).fit(signal[:, None]).amplitude[0]
    found = LineEstimator(WINDOW, RATE, tone, harmonics).fit(signal[:, None]).amplitude[0]
    assert abs(plain - weak) > 0.1 * abs(weak)
    assert abs(found - weak) < 1e-6 * abs(weak)


def test_the_stated_variance_is_the_scatter_over_many_recordings() -> None:
    rng = np.random.default_rng(2)
    estimator = LineEstimator(WINDOW, RATE, 133.0, 61.0 * np.arange(1, 11))
    signals = sine(0.5, 133.0)[:, None] + 0.01 * rng.standard_normal((FRAMES, 500))
    found = estimator.fit(signals)
    scatter = np.mean(np.abs(found.amplitude - 0.5) ** 2)
    assert np.median(found.variance) == pytest.approx(scatter, rel=0.15)


def test_a_line_of_other_origin_nearby_is_not_taken_for_noise() -> None:
    rng = np.random.default_rng(3)
    noise = 0.01 * rng.standard_normal((FRAMES, 1))
    estimator = LineEstimator(WINDOW, RATE, 133.0, np.array([100.0]))
    alone = estimator.fit(noise).variance
    beside = estimator.fit(noise + sine(1.0, 120.0)[:, None]).variance
    assert beside < 4 * alone


def test_what_is_heard_in_silence_counts_at_its_own_frequency() -> None:
    rng = np.random.default_rng(4)
    time = np.arange(20 * FRAMES) / RATE
    silence = 0.1 * np.sin(2 * np.pi * 50 * time)[:, None] + 0.01 * rng.standard_normal((len(time), 1))
    assert background(silence, WINDOW, RATE, 50.0)[0] == pytest.approx(0.1**2, rel=0.05)
    white = 4 * 0.01**2 * np.sum(WINDOW**2) / WINDOW.sum() ** 2
    assert background(silence, WINDOW, RATE, 300.0)[0] == pytest.approx(white, rel=0.5)
