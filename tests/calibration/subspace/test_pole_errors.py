"""Standard errors of frequencies and dampings against the spread over many records."""

import numpy as np
import pytest

from calibration import subspace
from tests.calibration.resonant_systems import RATE, order_7


@pytest.mark.slow
def test_the_truth_lies_within_two_standard_errors_as_often_as_it_should() -> None:
    """30 records, four frequencies and three dampings each: 95 % within, were the errors normal and exactly known."""
    system = order_7()
    truth = system.model.modes
    within = []
    for seed in range(30):
        found = subspace.identify(*system.record(4000, seed), RATE, order=7, horizon=20)
        errors, modes = found.pole_errors, found.model.modes
        within.append(np.abs(modes.frequency - truth.frequency) < 2 * errors.frequency)
        within.append((np.abs(modes.damping - truth.damping) < 2 * errors.damping)[truth.damping < 1])
    assert 0.88 < np.mean(np.concatenate(within)) < 0.99


def test_errors_fall_with_the_root_of_the_length() -> None:
    system = order_7()
    short, long = (
        subspace.identify(*system.record(samples, seed=1), RATE, order=7, horizon=20).pole_errors
        for samples in (4000, 64_000)
    )
    ratio = np.exp(np.mean(np.log(short.frequency / long.frequency)))
    assert 2.5 < ratio < 6


def test_a_record_without_noise_leaves_no_doubt() -> None:
    found = subspace.identify(*order_7().record(2000, seed=2, noise=0.0), RATE, order=7, horizon=20)
    assert np.all(found.pole_errors.frequency < 1e-6)
