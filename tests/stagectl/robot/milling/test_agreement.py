"""A slope and a lateness with how far off they may be: as far as they are, over many draws of noise."""

import numpy as np
import pytest

from stagectl.robot.milling.agreement import agreement, lateness
from stagectl.robot.milling.zero_phase import filtered
from tests.stagectl.robot.milling.test_witness import RATE, wandering

DRAWS = 30


def lasting(seed: int) -> np.ndarray:
    """Return noise up to some 1 Hz, 1 rms."""
    white = np.random.default_rng(1_000 + seed).standard_normal((2_500, 3))
    slow = filtered(white, RATE, lambda f: np.exp(-(f**2))[:, None, None] * np.eye(3))
    return np.asarray(slow / slow.std())


def measured(seed: int, scale: float = 1.0) -> np.ndarray:
    """Return what was foreseen, with noise that lasts beside white noise."""
    white = 5e-5 * np.random.default_rng(seed).standard_normal((2_500, 3))
    return np.asarray(scale * wandering(1e-5) + 5e-6 * lasting(seed) + white)


def test_the_standard_error_of_a_slope_is_how_slopes_differ() -> None:
    found = [agreement(measured(seed), wandering(1e-5), RATE) for seed in range(DRAWS)]
    slopes, told = np.array([each.slope for each in found]), np.mean([each.deviation for each in found])
    assert slopes.mean() == pytest.approx(1.0, abs=3 * told / np.sqrt(DRAWS))
    assert 0.7 < slopes.std() / told < 1.5


def test_white_noise_up_to_5_hz_is_told_by_what_is_beyond_25() -> None:
    white = np.random.default_rng(3).standard_normal((5_000, 3))
    found = agreement(white, white, RATE)
    assert found.noise == pytest.approx(found.measured, rel=0.1)


def test_a_shift_is_found_with_its_sign_and_how_sure_it_is() -> None:
    foreseen = wandering(1e-4)
    late, sure = lateness(foreseen, np.roll(foreseen, 25, axis=0), RATE, 0.3, 0.04)
    assert late == pytest.approx(0.1)
    assert sure > 4.0
    assert lateness(foreseen, np.roll(foreseen, -5, axis=0), RATE, 0.3, 0.04) == (-0.02, 0.0)


def test_noise_alone_is_late_by_anything_and_never_surely() -> None:
    found = [lateness(measured(seed, 0.0), wandering(1e-5), RATE, 0.3, 0.04) for seed in range(DRAWS)]
    assert max(abs(late) for late, _ in found) > 0.1
    assert sum(sure > 4.0 for _, sure in found) == 0
