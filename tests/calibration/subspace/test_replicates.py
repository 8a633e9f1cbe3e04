"""Errors of responses from what segments of the records say, each left out in turn."""

import numpy as np
import pytest

from calibration import subspace
from tests.calibration.resonant_systems import RATE, order_7
from tests.calibration.subspace.test_feedback import record

FREQUENCY = np.linspace(2.0, 300.0, 40)


@pytest.mark.slow
def test_the_truth_lies_within_them_as_often_as_it_should() -> None:
    """24 records; frequencies of one have their errors in common, so that the share scatters."""
    system, drive = order_7(), np.random.default_rng(7).standard_normal((80, 1))
    true, runs = system.model.frequency_response(FREQUENCY), system.model.simulate(drive)
    shares = []
    for seed in range(24):
        found = subspace.identify(*system.record(3000, seed=300 + seed), RATE, order=7, horizon=20)
        response, errors = found.model.frequency_response(FREQUENCY), found.response_errors(FREQUENCY)
        off = np.abs(found.model.simulate(drive) - runs)
        shares.append(
            [
                np.mean(np.abs(np.abs(response) - np.abs(true)) < 1.96 * errors.magnitude),
                np.mean(np.abs(np.angle(response / true)) < 1.96 * errors.phase),
                np.mean(off < 1.96 * found.simulation_errors(drive)),
            ]
        )
    within = np.mean(shares, axis=0)
    assert within.min() > 0.88
    assert within.max() < 0.995


def test_they_know_of_dead_time_and_of_several_records() -> None:
    """A record in two parts is no less sure, and one heard 20 samples late as sure as one heard at once."""
    system = order_7()
    u, y = system.record(4000, seed=1)
    at_once = subspace.identify(u, y, RATE, order=7, horizon=20)
    late = subspace.identify(np.roll(u, -20, axis=0)[:-20], y[:-20], RATE, order=7, horizon=20, delay=20)
    halves = subspace.identify([u[:2000], u[2000:]], [y[:2000], y[2000:]], RATE, order=7, horizon=20)
    wanted = at_once.response_errors(FREQUENCY)
    for found in (late, halves):
        ratio = found.response_errors(FREQUENCY).magnitude / wanted.magnitude
        assert 0.6 < np.median(ratio) < 1.7
    drive = np.zeros((60, 1))
    drive[0] = 1.0
    waits = late.simulation_errors(drive)
    assert np.all(waits[:20] == 0.0)
    assert waits[20:].min() > 0.0


def test_of_a_plant_in_a_loop_they_are_those_of_the_prediction_error() -> None:
    found = subspace.identify(*record(8000, 1, 0.5, 1.0), 1.0, order=3, horizon=30)
    assert found.refined is not None
    grid = np.linspace(0.01, 0.4, 9)
    errors = found.response_errors(grid)
    expected = found.refined.sensitivities.response_errors(found.core, grid)
    np.testing.assert_array_equal(errors.magnitude, expected.magnitude)
    assert np.all(errors.magnitude > 0)
