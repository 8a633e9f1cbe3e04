"""Readings of lasers that are stale, stuck or impossible; and those of every rate that are none of it."""

import numpy as np
import pytest

from stagectl.stage import laser_check_kernel as kernel
from stagectl.stage.laser_check import LaserCheck, LaserLimits

RATE, MIDDLE = 10_000.0, 225e-6


def readings(cycles: float, samples: int = 20_000, lag: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return readings (m) of a plate at rest, and their ages (s), shape (samples, 1) each, `lag` samples late."""
    period = round(RATE / cycles)
    n = np.arange(samples)
    noise = np.random.default_rng(3).standard_normal(samples // period + 1)
    shown = np.rint((MIDDLE + 1e-7 * noise[n // period]) / 2e-7) * 2e-7
    age = (period + n % period + lag) / RATE
    return shown[:, None], age[:, None]


def checked(cycles: float, reading: np.ndarray, age: np.ndarray) -> tuple[LaserCheck, np.ndarray]:
    """Return a check of a laser of that rate that has seen it all, and what it let through."""
    check = LaserCheck(LaserLimits(cycles, 1e-3, 200, 0.25), MIDDLE, 1.6e-3, 1)
    check.prepare(RATE, len(reading))
    valid, valid_age, fault = np.zeros_like(reading), np.zeros_like(reading), np.zeros_like(reading)
    check.process(reading, age, valid, valid_age, fault)
    assert (fault[-1, 0] != 0) == (check.fault is not None)
    return check, valid


@pytest.mark.parametrize("cycles", [400.0, 1_000.0, 5_000.0, 10_000.0])
def test_a_laser_of_any_rate_goes_through_as_it_is(cycles: float) -> None:
    reading, age = readings(cycles)
    check, valid = checked(cycles, reading, age)
    assert check.fault is None
    assert check.held == 0
    np.testing.assert_array_equal(valid, reading)
    assert check.greatest_age() == pytest.approx(2 / cycles - 1 / RATE)


@pytest.mark.parametrize("cycles", [400.0, 1_000.0, 5_000.0, 10_000.0])
@pytest.mark.parametrize(
    ("what", "kind", "words"),
    [
        ("lags", kernel.STALE, "laser 1 is stale"),
        ("is silent", kernel.STALE, "laser 1 is stale"),
        ("sticks", kernel.STUCK, "laser 1 is stuck"),
        ("jumps", kernel.JUMP, "laser 1 jumps"),
        ("sees nothing", kernel.RANGE, "laser 1 is out of its range"),
    ],
)
def test_what_a_laser_cannot_do_is_a_fault_of_its_own(cycles: float, what: str, kind: int, words: str) -> None:
    reading, age = readings(cycles)
    late = slice(10_000, None)
    match what:
        case "lags":
            age[late] += 5e-3
        case "is silent":
            reading[late], age[late, 0] = reading[10_000], age[10_000, 0] + np.arange(10_000) / RATE
        case "sticks":
            reading[late] = reading[10_000]
        case "jumps":
            reading[late] += 1e-3
        case _:
            reading[late] = np.nan
    check, _ = checked(cycles, reading, age)
    assert check.fault is not None
    assert check.fault.kind == kind
    assert words in str(check.fault)


def test_one_reading_that_cannot_be_is_held_off_and_one_that_is_lost_is_borne() -> None:
    reading, age = readings(5_000.0)
    reading[5_000:5_002] += 1e-3
    reading[7_000:7_002], age[7_000:7_002] = reading[6_999], age[6_999] + np.array([[1], [2]]) / RATE
    check, valid = checked(5_000.0, reading, age)
    assert check.fault is None
    assert check.held == 1
    assert np.abs(valid - MIDDLE).max() < 1e-6


def test_a_fault_is_kept_until_it_is_cleared() -> None:
    reading, age = readings(5_000.0)
    check, _ = checked(5_000.0, reading + 2e-3, age)
    valid, valid_age, fault = np.zeros_like(reading), np.zeros_like(reading), np.zeros_like(reading)
    check.process(reading, age, valid, valid_age, fault)
    assert fault.min() == kernel.RANGE
    check.clear()
    check.process(reading, age, valid, valid_age, fault)
    assert check.fault is None
