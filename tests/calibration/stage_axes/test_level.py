"""How loud chirps may be, by what weaker ones moved."""

import numpy as np
import pytest

from calibration.stage_axes.level import STEEPEST, Step, strongest


def moved(amplitude: float, power: float) -> Step:
    return Step(amplitude, np.array([1e-6 * amplitude**power, 3e-7 * amplitude]))


@pytest.mark.parametrize("power", [1.0, 1.3, 2.0])
def test_two_steps_foresee_what_grows_by_a_power_of_the_drive(power: float) -> None:
    found = strongest([moved(1.0, power), moved(8.0, power)], np.array([1e-6 * 24.0**power, 1.0]))
    assert found == pytest.approx(24.0)


def test_the_tightest_of_all_that_moves_counts() -> None:
    assert strongest([moved(1.0, 1.0)], np.array([50e-6, 3e-6])) == pytest.approx(10.0)


def test_what_seems_to_grow_less_or_explode_is_taken_as_straight_or_as_steepest() -> None:
    shrinks = [Step(1.0, np.array([1.0])), Step(2.0, np.array([1.0]))]
    assert strongest(shrinks, np.array([4.0])) == 8.0
    breaks_away = [Step(1.0, np.array([1.0])), Step(2.0, np.array([1e3]))]
    assert strongest(breaks_away, np.array([1e3 * 2.0**STEEPEST])) == pytest.approx(4.0)
