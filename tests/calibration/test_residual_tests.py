"""Whiteness of residuals and their correlation with the drive: levels under chance, and power against faults."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration.residual_tests import cross_correlation, whiteness


def noise(seed: int, samples: int = 2000, width: int = 2) -> np.ndarray:
    """Return white noise of unlike, dependent channels."""
    return np.random.default_rng(seed).standard_normal((samples, width)) @ np.array([[3.0, 0.5], [0.0, 0.1]])


def test_white_residuals_are_called_white_as_often_as_chance_says() -> None:
    found = [whiteness([noise(seed)]) for seed in range(200)]
    assert np.mean([each.probability < 0.05 for each in found]) == pytest.approx(0.05, abs=0.04)
    assert np.mean([each.outside for each in found]) == pytest.approx(0.01, abs=0.004)


def test_a_weak_colour_is_found() -> None:
    coloured = lfilter([1.0, 0.2], [1.0], noise(1), axis=0)
    found = whiteness([coloured])
    assert found.probability < 1e-6
    assert abs(found.correlation[0, 0, 0]) > found.bound


def test_one_output_that_foretells_the_other_is_found() -> None:
    residual = np.random.default_rng(2).standard_normal((2000, 2))
    residual[3:, 1] += 0.2 * residual[:-3, 0]
    found = whiteness([residual])
    assert found.probability < 1e-3
    assert np.unravel_index(np.argmax(np.abs(found.correlation)), (25, 2, 2)) == (2, 1, 0)


def test_coefficients_fitted_to_the_residuals_make_the_test_stricter() -> None:
    residual = noise(3)
    assert whiteness([residual], fitted=20).probability < whiteness([residual]).probability


def test_residuals_apart_from_a_coloured_drive_are_within_their_bound() -> None:
    outside = []
    for seed in range(50):
        rng = np.random.default_rng(seed)
        drive, residual = (
            lfilter([1.0], [1.0, -0.9], rng.standard_normal((4000, width)), axis=0)[500:] for width in (1, 2)
        )
        outside.append(cross_correlation([residual], [drive], 40).outside)
    assert np.mean(outside) == pytest.approx(0.01, abs=0.02)


def test_a_response_left_out_shows_at_its_delay_and_feedback_at_negative_lags() -> None:
    rng = np.random.default_rng(4)
    drive, residual = rng.standard_normal((2000, 2)), rng.standard_normal((2000, 1))
    residual[7:, 0] += 0.3 * drive[:-7, 1]
    found = cross_correlation([residual], [drive])
    lag, _, channel = np.unravel_index(np.argmax(np.abs(found.correlation)), found.correlation.shape)
    assert (found.lag[lag], channel) == (7, 1)
    back = cross_correlation([drive[:, 1:]], [residual])
    assert back.lag[np.argmax(np.abs(back.correlation[:, 0, 0]))] == -7


def test_several_records_are_not_correlated_across_their_joints() -> None:
    rng = np.random.default_rng(5)
    drive = rng.standard_normal((3000, 1))
    parts = [slice(0, 1000), slice(1000, 3000)]
    residual = drive[::-1].copy()
    joined = cross_correlation([residual[part] for part in parts], [drive[part] for part in parts], 5)
    sums = [residual[part][3:].T @ drive[part][:-3] for part in parts]
    assert joined.correlation[8, 0, 0] == pytest.approx(sum(sums)[0, 0] / np.sum(drive**2), abs=2e-3)


def test_a_record_too_short_or_a_signal_that_never_changes_is_refused() -> None:
    with pytest.raises(ValueError, match="a residual has 25 samples, must have more than the 25 lags"):
        whiteness([np.zeros((25, 1))])
    with pytest.raises(ValueError, match="residual 2 never changes"):
        cross_correlation([noise(6) * [1.0, 0.0]], [noise(7)])


def test_a_drive_at_rest_goes_with_nothing() -> None:
    both = cross_correlation([noise(6)], [noise(7)])
    found = cross_correlation([noise(6)], [noise(7) * [1.0, 0.0]])
    np.testing.assert_array_equal(found.correlation[..., 0], both.correlation[..., 0])
    np.testing.assert_array_equal(found.correlation[..., 1], 0.0)
    assert np.isfinite(found.bound).all()
