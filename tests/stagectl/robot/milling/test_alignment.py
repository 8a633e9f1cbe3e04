"""Records of other clocks brought to the trial's: shifts found to a fraction of a sample, gaps refused by name."""

import numpy as np
import pytest

from stagectl.robot.milling.alignment import on_grid, shift
from tests.stagectl.robot.milling.trial_models import RATE, square


@pytest.mark.parametrize("late", [-0.21, -0.0137, 0.0, 0.0052, 0.3])
def test_a_shift_is_found_to_a_tenth_of_a_sample_in_noise(late: float) -> None:
    path = square()
    time = np.arange(len(path)) / RATE
    rng = np.random.default_rng(3)
    moved = np.stack([np.interp(time - late, time, each) for each in path.T], axis=-1)
    moved += np.array([1e-3, -2e-3, 0.0]) + 30e-6 * rng.standard_normal(path.shape)
    assert shift(path, moved, RATE, 0.5) == pytest.approx(late, abs=4e-4)


def test_a_record_that_begins_elsewhere_and_is_shorter_is_aligned() -> None:
    path = square()
    assert shift(path, path[100:-50], RATE, 0.6) == pytest.approx(-0.4, abs=1e-5)


def test_records_that_do_not_overlap_are_refused() -> None:
    with pytest.raises(ValueError, match="does not move"):
        shift(np.zeros((100, 3)), square(), RATE, 0.1)


def test_samples_of_another_rate_are_brought_to_the_grid() -> None:
    time = np.arange(0.0, 2.0, 1 / 440.0)
    values = np.column_stack([time, 3.0 - time])
    grid = np.arange(100) / RATE
    got = on_grid(time, values, grid, 0.02, "tracker")
    assert got == pytest.approx(np.column_stack([grid, 3.0 - grid]))


@pytest.mark.parametrize(
    ("time", "values", "words"),
    [
        ([0.0, 0.1, 0.3, 0.4], [1, 1, 1, 1], "torque: there is no sample for 0.2 s from 0.1 s on, must be <= 0.15 s"),
        ([0.0, 0.1, 0.1, 0.2], [1, 1, 1, 1], "torque: its time does not rise at sample 2"),
        ([0.0, 0.1, 0.2, 0.3], [1, np.nan, 1, 1], "torque: it is not finite at 0.1 s"),
        ([0.0, 0.05, 0.1], [1, 1, 1], "torque: it lasts from 0 to 0.1 s, must last from 0 to 0.4 s"),
    ],
)
def test_what_cannot_be_used_is_refused_by_place(time: list[float], values: list[float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        on_grid(np.array(time), np.array(values, float)[:, None], np.linspace(0.0, 0.4, 5), 0.15, "torque")
