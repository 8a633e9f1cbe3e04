"""The order rule: the largest fall of the singular values, among orders that do well on held-back records."""

import numpy as np

from calibration.stage_axes.order import MARGIN, MOST, identify, proposed, tried
from calibration.subspace.order import Candidate
from tests.calibration.resonant_systems import RATE, order_7, sweep


def candidates(*fits: float) -> list[Candidate]:
    return [Candidate(order, fit, fit, 40) for order, fit in enumerate(fits, start=1)]


def test_the_largest_fall_counts_only_among_orders_that_do_well() -> None:
    values = np.array([100.0, 1.0, 0.9, 0.1, 0.09, 0.08])
    assert proposed(values, candidates(50.0, 80.0, 94.0, 95.0, 95.5)) == 3


def test_a_larger_order_that_fits_a_little_better_is_not_taken_for_it() -> None:
    values = np.array([10.0, 9.0, 0.1, 0.09, 0.05, 0.04])
    assert proposed(values, candidates(10.0, 94.0, 94.5, 95.0, 94.0 + MARGIN)) == 2


def records(count: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
    system, random = order_7(), np.random.default_rng(4)
    drives = [sweep(6000 + 1000 * part, 1.0, 200.0) * (-1) ** part for part in range(count)]
    return drives, [system.model.simulate(drive) + 0.02 * random.standard_normal((len(drive), 1)) for drive in drives]


def test_a_linear_system_of_order_seven_is_found_from_chirps() -> None:
    found = identify(*records(2), RATE, None, "moesp")
    assert found.model.order == 7
    assert len(found.candidates) == MOST
    oscillating = found.model.modes.frequency[found.model.modes.damping < 0.5]
    np.testing.assert_allclose(oscillating, [62.0, 95.0, 128.0], rtol=2e-3)


def test_an_order_that_is_given_is_taken() -> None:
    assert identify(*records(2), RATE, 4, "moesp").model.order == 4


def test_fits_are_those_of_records_that_were_left_out() -> None:
    drives, responses = records(2)
    honest = tried(drives, responses, "moesp")
    responses[1] = np.random.default_rng(5).standard_normal(responses[1].shape)
    fooled = tried(drives, responses, "moesp")
    assert honest[6].free_run > 90
    assert fooled[6].free_run < 30
