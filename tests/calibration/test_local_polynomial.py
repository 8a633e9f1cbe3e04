import numpy as np
import pytest

from calibration.local_polynomial import local_polynomial

LINES = np.setdiff1d(np.arange(1.0, 401.0, 2.0), np.arange(5.0, 400.0, 14.0))


def test_a_polynomial_is_found_exactly_between_the_lines_and_at_both_ends() -> None:
    wanted = np.arange(1.0, 400.0)
    coefficients = np.array([1 + 2j, 0.1j, -0.003, 2e-5j, 1e-8])
    found = local_polynomial(LINES, np.polynomial.polynomial.polyval(LINES, coefficients), wanted, 8, 4)
    assert np.allclose(found.value, np.polynomial.polynomial.polyval(wanted, coefficients))
    assert found.variance.max() < 1e-9  # rounding, of values up to 300


def test_the_error_in_noise_is_what_the_variance_says() -> None:
    """Windows of 17 lines, 5 coefficients: (|e|^2 / variance) is F-distributed with 2 and 24 degrees of freedom."""
    rng = np.random.default_rng(4)
    noise = rng.standard_normal((len(LINES), 60, 2)) @ np.array([1, 1j]) * 0.1
    smooth = np.exp(1j * LINES / 80)[:, None]
    wanted = LINES[20:-20:10]
    found = local_polynomial(LINES, smooth + noise, wanted, 8, 4)
    ratio = np.abs(found.value - np.exp(1j * wanted / 80)[:, None]) ** 2 / found.variance
    assert np.median(ratio) == pytest.approx(0.71, rel=0.15)
    assert np.percentile(ratio, 95) == pytest.approx(3.40, rel=0.15)


def test_where_the_response_bends_too_fast_the_variance_says_so() -> None:
    narrow = 1 / (1 + 1j * (LINES - 200) / 2)
    found = local_polynomial(LINES, narrow, np.array([60.0, 200.0]), 8, 4)
    assert found.variance[1] > 1000 * found.variance[0]


@pytest.mark.parametrize(
    ("lines", "degree", "words"), [(16, 4, "16 lines, must be at least 17"), (40, 16, "must be 0 to 15")]
)
def test_what_cannot_be_fitted_is_refused(lines: int, degree: int, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        local_polynomial(LINES[:lines], np.ones(lines, complex), LINES[:2], 8, degree)
