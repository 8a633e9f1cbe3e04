"""The robot's deflection, seen by lasers of every rate while the plate moves."""

import numpy as np
import pytest

from stagectl.stage.laser_deflection import LaserDeflection

RATE = 10_000.0


def compensated(period: int, plate: np.ndarray, robot: np.ndarray) -> np.ndarray:
    """Return what is taken off a reference of zero, shape (samples,), m: readings are `period` samples old at first."""
    n = np.arange(len(plate))
    taken = n // period * period - period
    laser = np.where(taken < 0, 0.0, (plate + robot)[taken])[:, None]
    age = ((n - taken) / RATE)[:, None]
    block = LaserDeflection(0.4 * RATE / period, 0.01, 1)
    block.prepare(RATE, len(plate))
    block.fade_in()
    reference = np.zeros((len(plate), 1))
    block.process(np.zeros((len(plate), 1)), laser, age, plate[:, None], reference)
    return -reference[:, 0]


@pytest.mark.parametrize("period", [1, 2, 10, 25])
def test_a_plate_that_moves_leaves_no_trace_at_any_rate_of_the_laser(period: int) -> None:
    time = np.arange(5_000) / RATE
    plate = 1e-4 * np.sin(2 * np.pi * 67 * time)
    assert np.abs(compensated(period, plate, np.zeros_like(plate))).max() < 1e-12


@pytest.mark.parametrize("period", [1, 2, 10, 25])
def test_a_robot_that_gives_way_slowly_is_followed(period: int) -> None:
    time = np.arange(10_000) / RATE
    robot = 1e-4 * time
    seen = compensated(period, 1e-4 * np.sin(2 * np.pi * 20 * time), robot)
    pole = np.exp(-2 * np.pi * 0.4 / period)
    late = (1.5 * period - 0.5 + pole / (1 - pole)) / RATE
    np.testing.assert_allclose((robot - seen)[2_000:].mean(), 1e-4 * late, rtol=0.02)


def test_faded_out_it_takes_nothing_off() -> None:
    block = LaserDeflection(2_000.0, 0.01, 1)
    block.prepare(RATE, 500)
    one, age, reference = np.ones((500, 1)), np.full((500, 1), 1e-4), np.zeros((500, 1))
    block.process(one, one, age, 0 * one, reference)
    np.testing.assert_array_equal(reference, one)
    block.fade_in()
    block.process(one, one, age, 0 * one, reference)
    assert reference[-1, 0] == pytest.approx(0.0, abs=1e-9)
    block.fade_out()
    block.process(one, one, age, 0 * one, reference)
    assert reference[-1, 0] == 1.0
    assert np.abs(np.diff(reference[:, 0])).max() < 0.02
