"""What changes a response beyond G: noise read from the silence, and distortion that follows the strong lines."""

import numpy as np
import pytest
from scipy.stats import chi2

from vibractl.learning.disturbance import FLOOR, KEPT, LEAST, MOST, Disturbance, noise_power, smoothed

RATE, SILENCE, FRAMES = 11_025.0, 2_205, 55_125
"""Of the default shot, decimated by 4: 0.2 s of silence before 5 s."""
FREQUENCY = np.arange(75, 3_251) * RATE / FRAMES
INDEPENDENT = 8
"""A median over 31 bins of a Hann window is about as good as a mean over so many independent ones."""


def level_of(density: float) -> float:
    """Return E |N|^2 in the lines of a shot, (unit s)^2, of white noise of a two-sided density, unit^2 / Hz."""
    return density * FRAMES / RATE


def white(seed: int, density: float) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((SILENCE, 2)) * np.sqrt(density * RATE)


def hum(amplitude: float, frequency: float) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(SILENCE) / RATE)[:, None]


@pytest.mark.parametrize("density", [1e-9, 3.0])
def test_white_noise_is_read_from_the_silence_within_chi_square_bounds(density: float) -> None:
    low, high = chi2.ppf([1e-4, 1 - 1e-4], 2 * INDEPENDENT) / (2 * INDEPENDENT)
    ratio = [noise_power(white(seed, density), RATE, FREQUENCY, FRAMES) / level_of(density) for seed in range(20)]
    assert np.mean(np.array(ratio) > low) > 0.999
    assert np.mean(np.array(ratio) < high) > 0.999
    assert 0.95 < np.mean(ratio) < 1.15


def test_hum_does_not_raise_the_noise_around_it() -> None:
    low, high = chi2.ppf([1e-4, 1 - 1e-4], 2 * INDEPENDENT) / (2 * INDEPENDENT)
    for seed in range(5):
        disturbed = white(seed, 1e-6) + hum(1.0, 50.0) + hum(0.1, 150.0)
        ratio = noise_power(disturbed, RATE, FREQUENCY, FRAMES) / level_of(1e-6)
        assert low < ratio.min()
        assert ratio.max() < 1.5 * high


def test_each_sensor_has_its_own_noise() -> None:
    silence = white(1, 1e-6) * [1.0, 10.0]
    power = noise_power(silence, RATE, FREQUENCY, FRAMES).mean(axis=0)
    assert power[1] / power[0] == pytest.approx(100, rel=0.2)


def test_noise_of_a_longer_shot_is_louder_in_its_lines() -> None:
    silence = white(1, 1e-6)
    once, twice = (noise_power(silence, RATE, FREQUENCY, frames) for frames in (FRAMES, 2 * FRAMES))
    np.testing.assert_allclose(twice, 2 * once)


def test_dead_silence_has_no_noise() -> None:
    np.testing.assert_array_equal(noise_power(np.zeros((SILENCE, 2)), RATE, FREQUENCY, FRAMES), 0.0)


@pytest.mark.parametrize("reach", [0, 1, 4, 10])
def test_smoothing_is_the_mean_over_the_lines_around_mirrored_at_the_ends(reach: int) -> None:
    power = np.random.default_rng(2).random((40, 3))
    around = np.arange(40)[:, None] + np.arange(-reach, reach + 1)
    mirrored = np.where(around < 0, -around, np.where(around > 39, 78 - around, around))
    np.testing.assert_allclose(smoothed(power, reach), power[mirrored].mean(axis=1), rtol=1e-12)


def disturbance(coupling: float = 4.0, reach: int = 0) -> Disturbance:
    """Return one for a reference of twenty strong lines among a hundred."""
    reference = np.zeros((100, 2), complex)
    reference[10:30] = 2.0
    return Disturbance(reference, coupling, reach)


def test_only_strong_lines_of_the_reference_count_as_change() -> None:
    response, step = np.full((100, 2), 2.0 + 0j), np.zeros((100, 2), complex)
    step[40:] = 1.0
    assert disturbance().change(step, response) == 0.0
    step[10:30, 1] = 0.2
    assert disturbance().change(step, response) == pytest.approx(0.1)


def test_a_dead_sensor_makes_the_change_large_and_not_a_number_that_is_none() -> None:
    step = np.full((100, 2), 0.1 + 0j)
    assert disturbance().change(step, np.zeros((100, 2), complex)) == pytest.approx(MOST)


def test_it_is_noise_and_distortion_and_never_nothing() -> None:
    noise, distortion = np.full((100, 2), 0.5), np.full((100, 2), 3.0)
    floor = (FLOOR * 2.0) ** 2
    np.testing.assert_allclose(disturbance(reach=1).power(noise, distortion, 0.1), 0.5 + 0.16 * 3.0 + floor)
    np.testing.assert_allclose(disturbance().power(0 * noise, 0 * distortion, 0.0), floor)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_distortion_up_to_the_coupling_s_order_changes_by_no_more_than_expected(order: int) -> None:
    """D of order n grows to D (1 + delta)^n when the strong lines do by delta."""
    rng = np.random.default_rng(3)
    reference = np.zeros((100, 2), complex)
    reference[10:30] = 2.0
    distortion = rng.standard_normal((100, 2)) + 1j * rng.standard_normal((100, 2))
    for delta in (-0.1, -0.02, 0.02):
        share = disturbance().change(delta * reference, reference)
        changed = np.abs(distortion * ((1 + delta) ** order - 1)) ** 2
        expected = disturbance().power(np.zeros((100, 2)), np.abs(distortion) ** 2, share)
        assert np.all((changed <= 1.07 * expected)[30:])  # (1 + delta)^4 is a little more than 1 + 4 delta


def test_strong_lines_that_stand_apart_follow_no_others() -> None:
    noise, distortion = np.full((100, 2), 0.5), np.full((100, 2), 3.0)
    apart = disturbance(reach=0)
    power = apart.power(noise, distortion, 0.1)
    np.testing.assert_array_equal(apart.tones, np.isin(np.arange(100), np.arange(10, 30)))
    np.testing.assert_allclose(power[10:30], 0.5 + (FLOOR * 2.0) ** 2)
    np.testing.assert_allclose(power[30:], 0.5 + 0.16 * 3.0 + (FLOOR * 2.0) ** 2)
    assert not disturbance(reach=1).tones.any()


@pytest.mark.parametrize("order", [0.5, 1.0, 3.0])
def test_the_coupling_of_the_strong_lines_is_measured_and_that_of_the_others_is_not(order: float) -> None:
    noise, distortion, part = np.full((100, 2), 1e-9), np.full((100, 2), 3.0), 0.1
    measured = disturbance(reach=1)
    for _ in range(KEPT):
        measured.observe((order * part) ** 2 * distortion + noise, noise, distortion, part)
    assert measured.coupling == pytest.approx(order)
    power = measured.power(0 * noise, distortion, part)
    np.testing.assert_allclose(power[11:29], (order * part) ** 2 * 3.0, rtol=1e-6)
    np.testing.assert_allclose(power[30:], 0.16 * 3.0, rtol=1e-6)


def test_a_coupling_is_never_more_than_configured_nor_taken_for_none() -> None:
    noise, distortion = np.full((100, 2), 1e-9), np.full((100, 2), 3.0)
    for surprise, coupling in ((100.0, 4.0), (0.0, LEAST)):
        measured = disturbance(reach=1)
        for _ in range(KEPT):
            measured.observe(surprise * distortion, noise, distortion, 0.1)
        assert measured.coupling == pytest.approx(coupling)


def test_a_shot_of_which_noise_hides_what_distortion_did_measures_no_coupling() -> None:
    noise, distortion = np.full((100, 2), 1.0), np.full((100, 2), 3.0)
    hidden = disturbance(reach=1)
    hidden.observe(noise, noise, distortion, 0.1)
    assert hidden.coupling == pytest.approx(4.0)


def test_without_a_coupling_none_is_measured() -> None:
    off, distortion = disturbance(coupling=0.0, reach=1), np.full((100, 2), 3.0)
    off.observe(distortion, 0 * distortion, distortion, 0.1)
    assert off.coupling == 0.0
