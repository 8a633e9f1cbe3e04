"""The filter that follows G: it finds it, knows how well, and leaves alone what it was not shown."""

import numpy as np
import pytest

from vibractl.learning.line_filter import SURE, LineFilter
from vibractl.learning.variation import Variation

LINES = 400
SHAPES = [(1, 1), (2, 2), (4, 4), (2, 1), (1, 2), (3, 4)]
"""Outputs, inputs."""
STEADY = 1e-4
"""The least walk."""


def spectra(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Return complex noise, E |x|^2 = 1."""
    return np.sqrt(0.5) * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))


def shown(response: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Return what a change of drive changes."""
    return (response @ step[..., None])[..., 0]


@pytest.mark.parametrize(("outputs", "inputs"), SHAPES)
def test_random_steps_show_it_the_whole_of_g(outputs: int, inputs: int) -> None:
    rng = np.random.default_rng(1)
    truth = spectra(rng, LINES, outputs, inputs)
    believed = truth + 0.5 * spectra(rng, *truth.shape)
    found = LineFilter(believed, np.full(truth.shape, 0.25), STEADY, 0.0, 0)
    noise = np.full((LINES, outputs), 1e-8)
    for _ in range(4 * inputs):
        step = spectra(rng, LINES, inputs)
        found.observe(step, shown(truth, step) + 1e-4 * spectra(rng, LINES, outputs), noise)
    assert np.median(np.abs(found.response - truth)) < 1e-3
    assert np.abs(found.response - truth).max() < 0.05


@pytest.mark.parametrize(("outputs", "inputs"), SHAPES)
def test_it_is_as_far_off_as_it_says(outputs: int, inputs: int) -> None:
    """|error|^2 / variance of a complex estimate is exponential: 1 on average, 95 % of it within 3.0."""
    rng = np.random.default_rng(2)
    deviation, noise, walk = 0.3, 0.04, 0.05
    truth = spectra(rng, LINES, outputs, inputs)
    size = np.sqrt((np.abs(truth) ** 2).mean(axis=2, keepdims=True))
    believed = truth + deviation * spectra(rng, *truth.shape)
    found = LineFilter(believed, np.full(truth.shape, deviation**2), walk, 0.0, 0)
    for shot in range(6):
        truth = truth + walk * size * spectra(rng, *truth.shape)
        step = 0.7**shot * spectra(rng, LINES, inputs)
        change = shown(truth, step) + np.sqrt(noise) * spectra(rng, LINES, outputs)
        found.observe(step, change, np.full((LINES, outputs), noise))
    normalised = np.abs(found.response - truth) ** 2 / found.variance
    assert 0.85 < normalised.mean() < 1.15
    assert 0.93 < np.mean(normalised < 3.0) < 0.97


def test_neighbours_make_a_smooth_g_surer_and_what_it_says_still_holds() -> None:
    rng = np.random.default_rng(3)
    place = np.arange(LINES) / 60
    truth = np.stack([np.exp(1j * place), 0.5 * np.exp(-2j * place)], axis=-1)[:, None, :]
    noise, deviation = np.full((LINES, 1), 0.01), np.full(truth.shape, 0.04)
    error = {}
    for neighbours in (0, 4):
        draw = np.random.default_rng(4)
        smooth = np.repeat(spectra(draw, LINES // 20, 1, 2), 20, axis=0)  # as a model's errors are
        found = LineFilter(truth + 0.2 * smooth, deviation, STEADY, 0.0, neighbours)
        for _ in range(3):
            step = spectra(rng, LINES, 2)
            found.observe(step, shown(truth, step) + 0.1 * spectra(rng, LINES, 1), noise)
        missed = np.abs(found.response - truth) ** 2
        error[neighbours] = missed.mean()
        assert np.mean(missed < 3.0 * found.variance) > 0.93
    assert error[4] < 0.5 * error[0]


def test_a_neighbour_that_differs_says_little() -> None:
    """G of every other line is another one: taken for the same they would be averaged."""
    rng = np.random.default_rng(5)
    truth = np.where(np.arange(LINES) % 2, 1.0 + 0j, -1.0)[:, None, None]
    found = LineFilter(truth, np.full(truth.shape, 1e-4), STEADY, 0.0, 2)
    for _ in range(5):
        step = spectra(rng, LINES, 1)
        found.observe(step, shown(truth, step), np.full((LINES, 1), 1e-6))
    assert np.abs(found.response - truth).max() < 1e-5


def test_what_is_announced_as_noise_does_not_leak_into_g() -> None:
    """Distortion as large as the change itself moves G no farther than the model's own uncertainty."""
    rng = np.random.default_rng(6)
    truth = np.ones((LINES, 1, 1), complex)
    announced, silent = (LineFilter(truth, np.full(truth.shape, 1e-4), STEADY, 0.0, 0) for _ in range(2))
    for _ in range(10):
        step, distortion = 0.1 * spectra(rng, LINES, 1), 0.1 * spectra(rng, LINES, 1)
        change = shown(truth, step) + distortion
        announced.observe(step, change, np.full((LINES, 1), 0.01))
        silent.observe(step, change, np.full((LINES, 1), 1e-6))
    assert np.mean(np.abs(announced.response - truth) ** 2 < 3.0 * announced.variance) > 0.94
    assert np.abs(announced.response - truth).max() < 0.02
    assert np.median(np.abs(silent.response - truth)) > 0.1


def test_an_input_that_stands_still_is_not_learned() -> None:
    rng = np.random.default_rng(7)
    believed = spectra(rng, LINES, 2, 2)
    found = LineFilter(believed, np.full(believed.shape, 0.04), STEADY, 0.0, 0)
    before = found.variance
    step = spectra(rng, LINES, 2) * [1.0, 0.0]
    found.observe(step, spectra(rng, LINES, 2), np.full((LINES, 2), 1e-4))
    np.testing.assert_allclose(found.response[..., 1], believed[..., 1], atol=1e-12)
    np.testing.assert_allclose(found.variance[..., 1], before[..., 1], rtol=1e-4)
    np.testing.assert_array_less(found.variance[..., 0], before[..., 0])


def test_without_a_step_g_only_becomes_less_certain() -> None:
    rng = np.random.default_rng(8)
    believed = spectra(rng, LINES, 2, 2)
    found = LineFilter(believed, np.zeros(believed.shape), 0.1, 0.0, 4)
    found.observe(np.zeros((LINES, 2), complex), spectra(rng, LINES, 2), np.full((LINES, 2), 1e-4))
    np.testing.assert_array_equal(found.response, believed)
    size = (np.abs(believed) ** 2).mean(axis=2, keepdims=True)
    np.testing.assert_allclose(found.variance, (0.1**2 + SURE**2) * np.broadcast_to(size, believed.shape), rtol=1e-9)


def test_only_lines_that_are_forgotten_are_doubted() -> None:
    believed = spectra(np.random.default_rng(9), LINES, 2, 3)
    found = LineFilter(believed, np.full(believed.shape, 0.01), STEADY, 0.0, 0)
    before, lines = found.variance, np.arange(LINES) < 10
    found.forget(lines, 1.0)
    np.testing.assert_array_equal(found.variance[~lines], before[~lines])
    size = (np.abs(believed[lines]) ** 2).mean(axis=2, keepdims=True)
    np.testing.assert_allclose(found.variance[lines] - before[lines], np.broadcast_to(size, (10, 2, 3)))


def test_the_model_it_starts_from_stays_as_it_is() -> None:
    rng = np.random.default_rng(10)
    believed = spectra(rng, LINES, 2, 2)
    kept, variance = believed.copy(), np.full(believed.shape, 0.1)
    found = LineFilter(believed, variance, 0.1, 0.2, 2)
    found.observe(spectra(rng, LINES, 2), spectra(rng, LINES, 2), np.full((LINES, 2), 1e-2))
    np.testing.assert_array_equal(believed, kept)
    np.testing.assert_array_equal(variance, 0.1)


ENDS_AND_SWINGS = [0.25, 0.25, 0.01, 0.01]
"""Squares of what is believed of the ends of a shot and of each swing, re G's own square."""


def varying(response: np.ndarray, swings: int = 1) -> LineFilter:
    frequency = 15.0 + np.arange(len(response))
    return LineFilter(response, np.zeros(response.shape), STEADY, 0.0, 0, Variation(frequency, 0.0, 0.0, swings))


def test_what_varies_while_a_shot_lasts_is_half_of_g_at_its_ends_a_tenth_in_swings_and_walks() -> None:
    found = varying(np.full((LINES, 1, 2), 2.0 + 0j))
    prior = 4.0 * np.repeat(ENDS_AND_SWINGS, 2)
    spread = np.einsum("...ii->...i", found.covariance).real[:, 0]
    np.testing.assert_allclose(spread[:, 2:], np.broadcast_to(prior, (LINES, 8)), rtol=1e-9)
    found.observe(np.zeros((LINES, 2), complex), np.zeros((LINES, 1), complex), np.ones((LINES, 1)))
    spread = np.einsum("...ii->...i", found.covariance).real[:, 0]
    np.testing.assert_allclose(spread[:, 2:], np.broadcast_to(1.01 * prior, (LINES, 8)), rtol=1e-9)
    assert found.couples is True
    assert LineFilter(found.response, np.zeros((LINES, 1, 2)), STEADY, 0.0, 0).couples is False


@pytest.mark.parametrize("varies", [False, True])
def test_a_step_is_found_that_is_believed_to_make_what_is_wanted(varies: bool) -> None:
    rng = np.random.default_rng(11)
    response = np.eye(2) + 0.2 * spectra(rng, LINES, 2, 2)
    found = varying(response) if varies else LineFilter(response, np.zeros(response.shape), STEADY, 0.0, 0)
    drive = spectra(rng, LINES, 2)
    found.observe(drive, 1.1 * shown(response, drive), np.full((LINES, 2), 1e-4))
    wanted = spectra(rng, LINES, 2)
    step = found.step_for(wanted, np.linalg.inv(found.response), np.ones((LINES, 2)))
    assert np.linalg.norm(wanted - found.explained(step)) < 0.05 * np.linalg.norm(wanted)


def test_how_far_a_step_may_be_off_follows_from_the_covariance() -> None:
    rng = np.random.default_rng(12)
    variance = rng.uniform(0.1, 1.0, (LINES, 2, 3))
    found = LineFilter(np.zeros((LINES, 2, 3), complex), variance, STEADY, 0.0, 0)
    step = spectra(rng, LINES, 3)
    np.testing.assert_allclose(found.spread(step), (variance @ (np.abs(step) ** 2)[..., None])[..., 0], rtol=1e-9)


def test_around_a_line_g_is_as_large_as_beside_it() -> None:
    """A notch of one line is not taken for a plant that hardly moves."""
    response = np.full((LINES, 1, 1), 2.0 + 0j)
    response[200] = 0.0
    around = LineFilter(response, np.zeros(response.shape), STEADY, 0.0, 0).around(np.full((LINES, 1), 3.0 + 0j))
    np.testing.assert_allclose(around[[50, 200]], 4.0 * 9.0, rtol=0.05)
