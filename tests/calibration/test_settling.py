import numpy as np
import pytest

from calibration.settling import left_over, unsettled


def test_a_response_that_rings_leaves_what_its_decay_leaves_in_the_window() -> None:
    rate, memory = 1000.0, np.array([0.05, 0.2])
    window = np.hanning(500)
    time = np.arange(500) / rate
    expected = [np.sum(window * np.exp(-(0.1 + time) / tau)) / window.sum() for tau in memory]
    assert left_over(memory, np.full((2, 1), 0.1), window, rate)[:, 0] == pytest.approx(expected)


def test_a_response_without_memory_leaves_nothing() -> None:
    assert left_over(np.zeros(1), np.zeros((1, 1)) + 0.1, np.ones(100), 1000.0)[0, 0] == pytest.approx(0, abs=1e-12)


def test_the_step_is_counted_from_the_tone_before_and_from_rest_in_full() -> None:
    response = np.arange(1.0, 4.0)[:, None, None] * np.ones((3, 2, 2)) * (1 + 0j)
    before = np.array([[-1, 1], [0, 2], [1, -1]])
    error = unsettled(response, before, np.full((3, 2), 0.1))
    assert error[:, :, 0] == pytest.approx(np.array([[0.01], [0.01], [0.01]]) * np.ones((1, 2)))
    assert error[:, :, 1] == pytest.approx(np.array([[0.01], [0.01], [0.09]]) * np.ones((1, 2)))
