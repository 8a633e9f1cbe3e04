"""Horizons that nobody chose: as long as the slowest oscillation wants, and as the records allow."""

import numpy as np
import pytest

from calibration import subspace
from calibration.state_space.model import InnovationModel
from calibration.subspace.horizons import longer, usual
from calibration.subspace.signals import Signals, signals
from tests.calibration.resonant_systems import order_7, order_18

TURN = np.array([[np.cos(0.02), np.sin(0.02)], [-np.sin(0.02), np.cos(0.02)]])
"""An oscillation of 314 samples a period, undamped."""


def noise(samples: int, inputs: int = 1, outputs: int = 1, records: int = 1) -> Signals:
    rng = np.random.default_rng(1)
    sides = ([rng.standard_normal((samples, width)) for _ in range(records)] for width in (inputs, outputs))
    return signals(*sides, True)


def worst_damping(found: InnovationModel, truth: InnovationModel) -> float:
    oscillating = truth.modes.damping < 1
    errors = found.modes.damping / truth.modes.damping - 1
    return float(np.abs(errors[oscillating]).max())


@pytest.mark.slow
def test_a_stage_sampled_at_its_own_rate_needs_no_thought_about_horizons() -> None:
    """40 samples at 10 kHz are a quarter of a period: that gives order 5 and a free run of 30 %."""
    system = order_7(10_000.0)
    found = subspace.identify(*system.record(40_000, seed=23), 10_000.0)
    assert found.model.order == 7
    assert worst_damping(found.model, system.model) < 0.1
    assert found.compare(*system.record(20_000, seed=24)).fit.free_run.nrmse[0] > 89
    assert found.horizon == (160, 160)


@pytest.mark.slow
def test_nine_modes_have_the_damping_that_least_errors_allow() -> None:
    system = order_18()
    found = subspace.identify(*system.record(10_000, seed=6), 1000.0, order=18)
    assert found.horizon >= (53, 53)
    assert worst_damping(found.model, system.model) < 0.03


def test_a_horizon_that_is_given_stays() -> None:
    found = subspace.identify(*order_7(10_000.0).record(4000, seed=25), 10_000.0, order=7, horizon=40)
    assert found.horizon == (40, 40)


def test_two_periods_are_reached_over_where_there_is_room() -> None:
    data = noise(100_000)
    found = longer(usual(data, 2), data, np.linalg.matrix_power(0.999 * TURN, 6))
    assert found is not None
    assert (found.past, found.future) == (105, 105)


def test_there_is_no_longer_horizon_than_records_and_memory_allow() -> None:
    slow = 0.9999 * TURN
    for data, horizon in (
        (noise(100_000), 160),
        (noise(100_000, 3, 3), 53),
        (noise(1000), 71),
        (noise(300, records=4), 60),
        (noise(300, records=40), 75),
    ):
        found = longer(usual(data, 2), data, slow)
        assert found is not None
        assert (found.past, found.future) == (horizon, horizon)


def test_nothing_changes_without_a_slow_oscillation() -> None:
    data = noise(100_000)
    for transition in (np.diag([0.999, 0.99]), np.linalg.matrix_power(TURN, 13), 0.98 * TURN):
        assert longer(usual(data, 2), data, transition) is None


def test_an_order_that_wants_more_of_the_future_gets_it_at_once() -> None:
    layout = usual(noise(4000), 30)
    assert (layout.past, layout.future) == (60, 60)
