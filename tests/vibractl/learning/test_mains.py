"""Mains hum heard in the silence, and how much of it the lines of a shot may hold."""

import numpy as np
import pytest

from tests.vibractl.learning.test_disturbance import FRAMES, FREQUENCY, RATE, SILENCE, level_of, white
from vibractl.learning.disturbance import noise_power
from vibractl.learning.mains import hum_power


def tone(frequency: float, amplitude: float, samples: int, phase: float = 0.3) -> np.ndarray:
    """Return a tone at two sensors, the second with a third of it."""
    wave = amplitude * np.sin(2 * np.pi * frequency * np.arange(samples) / RATE + phase)
    return wave[:, None] * [1.0, 1 / 3]


def in_lines(signal: np.ndarray) -> np.ndarray:
    """Return |H|^2 in the lines of a shot."""
    bins = np.arange(75, 3_251)
    return np.abs(np.fft.rfft(signal, axis=0)[bins] / RATE) ** 2


def found(silence: np.ndarray, frames: int = FRAMES) -> np.ndarray:
    return hum_power(silence, RATE, FREQUENCY, frames, noise_power(silence, RATE, FREQUENCY, frames))


@pytest.mark.parametrize("off", [-0.05, 0.0, 0.023, 0.05])
@pytest.mark.parametrize("name", [50, 60])
def test_no_line_holds_more_of_a_tone_than_is_found_and_few_are_suspected(name: int, off: float) -> None:
    signal = [(1, 0.3), (3, 0.02), (5, 0.01)]
    silence = white(2, 1e-9) + sum(tone(h * (name + off), a, SILENCE) for h, a in signal)
    power, truth = found(silence), in_lines(sum(tone(h * (name + off), a, FRAMES, 1.0 + h) for h, a in signal))
    loud = truth > 30 * level_of(1e-9)
    assert loud.any(axis=0).all()
    assert np.all(power[loud] > 0.5 * truth[loud])
    for harmonic, _ in signal:
        near = np.abs(FREQUENCY - harmonic * name) < 5.0
        assert np.all(power[near].max(axis=0) < 2.0 * truth[near].max(axis=0) / np.sinc(0.5) ** 2)
    between = np.abs(FREQUENCY - 1.5 * name) < 2.0
    assert np.all(power[between].max(axis=0) < 1e-3 * power.max(axis=0))


def test_noise_is_no_hum() -> None:
    assert sum(found(white(seed, 1e-6)).any() for seed in range(100)) <= 1


def test_a_mode_that_rings_after_the_last_shot_is_no_hum() -> None:
    time = np.arange(SILENCE) / RATE
    ringing = np.exp(-3.0 * time) * np.sin(2 * np.pi * 43.0 * time)
    power = found(white(1, 1e-9) + 0.1 * ringing[:, None])
    assert power.max() < 0.05 * (0.1 / 2 * FRAMES / RATE) ** 2


def test_a_silence_of_less_than_four_periods_tells_nothing() -> None:
    silence = white(1, 1e-9)[:500] + tone(50.0, 1.0, 500)
    assert not found(silence).any()
