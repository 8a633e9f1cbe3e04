import numpy as np
import pytest

from calibration.local_polynomial import local_polynomial, local_transfer

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
    ("lines", "degree", "words"), [(16, 4, "16 bins, must be at least 17"), (40, 16, "must be 0 to 15")]
)
def test_what_cannot_be_fitted_is_refused(lines: int, degree: int, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        local_polynomial(LINES[:lines], np.ones(lines, complex), LINES[:2], 8, degree)


def test_a_smooth_transfer_between_wild_spectra_is_found_and_its_variance_is_right() -> None:
    rng, lines = np.random.default_rng(2), np.arange(400.0)
    truth = np.stack([np.exp(1j * lines / 60), 0.5 + lines * 1j / 400], axis=-1)[:, None]
    given = 10 ** rng.uniform(-1, 1, (400, 2, 3)) * np.exp(2j * np.pi * rng.random((400, 2, 3)))
    noise = 0.05 * (rng.standard_normal((400, 1, 3)) + 1j * rng.standard_normal((400, 1, 3)))
    found = local_transfer(lines, given, truth @ given + noise, lines, 8, 2)
    normalised = np.abs(found.value - truth) ** 2 / found.variance
    assert normalised[50:350].mean() == pytest.approx(1.0, abs=0.3)
    assert np.abs(found.value - truth).max() < 0.05


def test_with_fewer_experiments_than_inputs_the_smallest_transfer_that_fits_is_taken() -> None:
    lines = np.arange(40.0)
    given = np.broadcast_to(np.array([[1.0], [2.0]]) + 0j, (40, 2, 1))
    found = local_transfer(lines, given, given[:, :1] + 2 * given[:, 1:], lines, 8, 1)
    np.testing.assert_allclose(found.value, np.broadcast_to([[1.0, 2.0]], (40, 1, 2)), atol=1e-9)


def test_too_few_equations_for_a_transfer_are_refused() -> None:
    with pytest.raises(ValueError, match="10 bins and 1 experiments, must be at least 17 bins, and more than 6 equat"):
        local_transfer(np.arange(10.0), np.ones((10, 2, 1)), np.ones((10, 1, 1)), np.arange(3.0), 8, 2)
