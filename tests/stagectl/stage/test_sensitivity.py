"""Margins and maximum sensitivity against loops whose figures are known in closed form."""

import numpy as np
import pytest

from stagectl.stage.sensitivity import robustness
from stagectl.stage.state_space import StateSpace

RATE = 1_000.0
ONE = StateSpace(np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)), np.ones((1, 1)))


def integrator(gain: float) -> StateSpace:
    """Make gain / (z - 1)."""
    return StateSpace(np.ones((1, 1)), np.ones((1, 1)), np.full((1, 1), gain), np.zeros((1, 1)))


def test_an_integrator_becomes_unstable_at_gain_two() -> None:
    figures = robustness(ONE, integrator(0.5), RATE)
    assert figures.stable
    assert figures.gain_margins == (0.0, pytest.approx(4.0, rel=1e-3))


def test_one_more_sample_of_delay_leaves_an_integrator_gain_one() -> None:
    figures = robustness(ONE, integrator(0.5), RATE, delay=1)
    assert figures.gain_margins[1] == pytest.approx(2.0, rel=1e-2)


def test_ms_of_an_integrator_is_that_of_its_formula() -> None:
    """S = (z - 1) / (z - 1 + g), largest at z = -1: 2 / (2 - g)."""
    figures = robustness(ONE, integrator(0.8), RATE)
    assert figures.max_sensitivity == pytest.approx(2 / 1.2, rel=1e-6)
    assert figures.at == RATE / 2


def test_phase_and_delay_margin_are_those_at_the_crossover() -> None:
    """|g / (z - 1)| = 1 at 2 sin(w/2) = g; the phase there is -90 degrees - w/2."""
    omega = 2 * np.arcsin(0.25)
    figures = robustness(ONE, integrator(0.5), RATE)
    margin = np.pi / 2 - omega / 2
    assert figures.crossover == pytest.approx(omega * RATE / (2 * np.pi), rel=1e-3)
    assert figures.phase_margin == pytest.approx(np.degrees(margin), rel=1e-3)
    assert figures.delay_margin == pytest.approx(margin / omega / RATE, rel=1e-3)


def test_a_loop_that_is_unstable_with_the_delay_alone_has_no_finite_ms() -> None:
    """One sample late, an integrator is stable below gain one."""
    assert robustness(ONE, integrator(1.2), RATE).stable
    figures = robustness(ONE, integrator(1.2), RATE, delay=1)
    assert not figures.stable
    assert figures.max_sensitivity == np.inf


def test_a_narrow_resonance_is_not_missed() -> None:
    """A mode of 0.01 % damping, seen in 0.01 Hz, decides Ms."""
    pole = np.exp((-1e-4 + 1j) * 2 * np.pi * 61.7 / RATE)
    A = np.array([[pole.real, -pole.imag], [pole.imag, pole.real]])
    mode = StateSpace(A, np.array([[1e-4], [0.0]]), np.array([[0.0, -1.0]]), np.zeros((1, 1)))
    figures = robustness(mode, ONE, RATE)
    dense = np.linspace(61.0, 62.4, 200_001)
    assert figures.max_sensitivity == pytest.approx(np.abs(1 / (1 + mode.response(dense, RATE))).max(), rel=0.02)
    assert figures.max_sensitivity > 1.3


def test_systems_in_series_multiply() -> None:
    frequency = np.array([1.0, 50.0, 333.0])
    both = integrator(0.3).then(integrator(2.0)).response(frequency, RATE)
    one = integrator(1.0).response(frequency, RATE)
    np.testing.assert_allclose(both, 0.6 * one**2, rtol=1e-10)
