"""Zeros mirrored into the unit circle."""

import numpy as np
import pytest

from stagectl.robot.midranging.minimum_phase import minimum_phase

CIRCLE = np.exp(1j * np.linspace(0.0, np.pi, 50))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_magnitude_on_the_unit_circle_stays_and_no_zero_is_left_outside(count: int) -> None:
    random = np.random.default_rng(count)
    for _ in range(300):
        numerator = random.standard_normal(count)
        mirrored = minimum_phase(numerator)
        np.testing.assert_allclose(abs(np.polyval(mirrored, CIRCLE)), abs(np.polyval(numerator, CIRCLE)), rtol=1e-9)
        assert np.polyval(mirrored, 1.0) == pytest.approx(np.polyval(numerator, 1.0), rel=1e-9, abs=1e-12)
        assert (abs(np.roots(mirrored)) <= 1.0 + 1e-9).all()


@pytest.mark.parametrize("inside", [[0.04], [1.0, 0.5], [1.0, -0.3, 0.02], [1.0, -1.0, 0.9], [0.2, 0.0, 0.0]])
def test_what_is_minimum_phase_stays_as_it_is(inside: list[float]) -> None:
    np.testing.assert_array_equal(minimum_phase(np.array(inside)), inside)


def test_a_zero_outside_keeps_its_argument_and_inverts_its_magnitude() -> None:
    zeros = np.array([1.6 * np.exp(0.7j), 1.6 * np.exp(-0.7j)])
    mirrored = np.roots(minimum_phase(np.poly(zeros).real))
    np.testing.assert_allclose(sorted(mirrored, key=np.imag), sorted(zeros / 1.6**2, key=np.imag), rtol=1e-9)


@pytest.mark.parametrize(
    ("outside", "expected"),
    [([0.0, 1.0], [1.0, 0.0]), ([0.0, 1.0, 0.5], [1.0, 0.5, 0.0]), ([0.0, 0.0, 2.0], [2.0, 0.0, 0.0])],
)
def test_a_zero_at_infinity_goes_to_the_origin(outside: list[float], expected: list[float]) -> None:
    np.testing.assert_allclose(minimum_phase(np.array(outside)), expected, atol=1e-15)


def test_another_number_of_coefficients_is_refused() -> None:
    with pytest.raises(ValueError, match="there are 4 coefficients, must be 1 to 3"):
        minimum_phase(np.ones(4))
