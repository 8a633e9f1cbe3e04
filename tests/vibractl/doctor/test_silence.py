"""Hum and noise, on signals of known level."""

import numpy as np
import pytest

from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.doctor.silence import Level, hum, line_density, noise, reference_level
from vibractl.quality import Judge
from vibractl.setup import setup

RATE = 44_100
ONE = Level(1.0, 2.0)
"""A tone of amplitude 1 has a line of 1 then: 0 dB."""


def tone(frequency: float, amplitude: float, seconds: float = 10.0) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(round(seconds * RATE)) / RATE)[:, None]


@pytest.mark.parametrize(("mains", "true"), [(50.0, 50.13), (60.0, 59.87)])
def test_a_harmonic_is_measured_though_the_mains_are_not_exact(mains: float, true: float) -> None:
    found = hum(np.hstack([tone(true, 0.3), tone(3 * true, 0.01)]), RATE, ONE, 645.0)
    assert found.mains == mains
    assert found.level[0] == pytest.approx(20 * np.log10(0.3), abs=0.15)
    assert found.level[2] == pytest.approx(-40.0, abs=0.15)
    assert found.response.tolist()[:3:2] == [1, 2]


def test_a_tone_beside_the_mains_is_no_hum() -> None:
    assert hum(tone(137.0, 1.0), RATE, ONE, 645.0).level.max() < -60


def test_noise_has_the_level_of_its_lines_and_hum_is_left_out() -> None:
    white = 0.1 * np.random.default_rng(3).standard_normal((10 * RATE, 2))
    middle, level = noise(white + tone(150.0, 5.0), RATE, ONE, (15.0, 645.0))
    assert middle.tolist() == [31.25, 62.5, 125.0, 250.0, 500.0]
    wanted = 20 * np.log10(0.1 * np.sqrt(2.0 / RATE))  # a record of 2 s: |N|^2 = variance / rate * seconds
    np.testing.assert_allclose(level, wanted, atol=1.0)


def test_the_lines_of_shots_of_noise_are_those_that_the_density_foretells() -> None:
    white = np.random.default_rng(5).standard_normal((10 * RATE, 1))
    _, density = line_density(white, RATE)
    shots = np.fft.rfft(white.reshape(5, 2 * RATE), axis=1) / RATE
    assert np.sqrt(np.mean(density) * 2.0) == pytest.approx(np.sqrt(np.mean(np.abs(shots) ** 2)), rel=0.02)


@pytest.mark.parametrize("signal", ["chirp:40:90:1", "chirp:40:90:5"])
def test_the_reference_has_the_level_that_a_shot_is_judged_against(signal: str) -> None:
    config = linear_config(f"reference.signal={signal}")
    judged = Judge(setup(config, linear_matrix())).reference_level
    assert reference_level(config).line == pytest.approx(judged[0], rel=1e-3)
    assert reference_level(config).seconds == float(signal[-1]) + 0.4  # until it has rung out
