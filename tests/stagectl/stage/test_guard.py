"""The guard lets nothing beyond its limits out and goes to rest on a fault, without a step."""

import numpy as np
import pytest

from stagectl.config import Limits
from stagectl.stage.guard import VoltageGuard

RATE = 10_000.0
LIMITS = Limits(voltage=(0.0, 100.0), voltage_slew=2e5, ramp=0.01)
OKAY = np.zeros((1, 1))


def sample(guard: VoltageGuard, request: float, fault: float = 0.0, other: float = 50.0) -> np.ndarray:
    voltage = np.empty((1, 2))
    guard.process(np.array([[request, other]]), np.full((1, 1), fault), voltage)
    return voltage[0]


def opened(limits: Limits = LIMITS) -> VoltageGuard:
    guard = VoltageGuard(limits, 2)
    guard.prepare(RATE, 1)
    while not guard.at_rest:
        sample(guard, 0.0)
    guard.open()
    return guard


def test_after_prepare_it_ramps_from_the_lowest_voltage_to_rest_and_stays() -> None:
    guard = VoltageGuard(LIMITS, 2)
    guard.prepare(RATE, 1)
    way = np.array([sample(guard, 77.0)[0] for _ in range(120)])
    assert 0 < way[0] < 0.1
    assert np.all(np.diff(way) >= 0)
    assert way[99] == way[119] == 50.0
    assert guard.at_rest


def test_within_limits_it_is_transparent_bit_for_bit() -> None:
    guard = opened()
    request = 50.0 + np.cumsum(np.random.default_rng(2).uniform(-1, 1, 200))
    assert [sample(guard, value)[0] for value in request] == list(request)
    assert guard.limited == (0, 0)


def test_a_request_that_begins_elsewhere_can_be_let_out_without_a_step() -> None:
    guard = VoltageGuard(LIMITS, 2)
    guard.prepare(RATE, 1)
    while not guard.at_rest:
        sample(guard, 0.0)
    guard.ease_open()
    way = np.array([sample(guard, 80.0 + n / 100) for n in range(150)])
    assert way[0, 0] == 50.0
    assert np.abs(np.diff(way[:, 0])).max() < 0.55
    np.testing.assert_array_equal(way[100:, 0], 80.0 + np.arange(100, 150) / 100)
    np.testing.assert_array_equal(way[:, 1], 50.0)


def test_range_and_rate_of_change_are_kept_and_counted() -> None:
    guard = opened()
    way = np.array([sample(guard, 300.0)[0] for _ in range(5)])
    np.testing.assert_allclose(way, [70.0, 90.0, 100.0, 100.0, 100.0])
    assert guard.limited == (5, 0)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_request_that_is_no_number_never_leaves_and_takes_every_axis_to_rest(bad: float) -> None:
    guard = opened()
    sample(guard, 60.0, other=40.0)
    way = np.array([sample(guard, bad, other=40.0) for _ in range(100)])
    assert np.abs(np.diff(way, axis=0, prepend=[[60.0, 40.0]])).max() < 0.16
    np.testing.assert_array_equal(way[-1], 50.0)
    assert guard.cause == "the request of axis 1 is not a number"


def test_a_fault_of_a_sensor_latches_and_the_request_does_not_matter_after_it() -> None:
    guard = opened()
    sample(guard, 60.0, fault=3.0)
    for _ in range(200):
        last = sample(guard, 99.0)
    np.testing.assert_array_equal(last, 50.0)
    assert guard.latched
    with pytest.raises(ValueError, match="the guard is latched, must be shut"):
        guard.open()


def test_rest_may_be_zero() -> None:
    guard = opened(LIMITS.model_copy(update={"rest": "zero"}))
    sample(guard, 10.0)
    guard.close()
    for _ in range(100):
        last = sample(guard, 10.0)
    np.testing.assert_array_equal(last, 0.0)


def test_only_a_person_clears_a_latch_and_only_at_rest() -> None:
    guard = opened()
    with pytest.raises(ValueError, match="not latched"):
        guard.clear("anna")
    guard.trip("the host is silent")
    with pytest.raises(ValueError, match="must be a person's name"):
        guard.clear("  ")
    sample(guard, 60.0)
    with pytest.raises(ValueError, match="still goes to rest"):
        guard.clear("anna")
    for _ in range(100):
        sample(guard, 60.0)
    assert guard.clear("anna") == "the host is silent"
    guard.open()
    assert sample(guard, 55.0)[0] == 55.0


def test_a_latch_survives_prepare() -> None:
    guard = opened()
    guard.trip("an emergency stop")
    guard.prepare(RATE, 1)
    assert guard.latched
    assert guard.cause == "an emergency stop"


def test_a_ramp_too_short_for_the_rate_of_change_is_refused() -> None:
    with pytest.raises(ValueError, match=r"limits.ramp is 0.001 s, must be >= 0.0157 s"):
        Limits(voltage=(0.0, 100.0), ramp=0.001, voltage_slew=1e4)
