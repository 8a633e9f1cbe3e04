"""The limit of chatter by the mean of the teeth's directions, against that of the periodic equation."""

import numpy as np
import pytest

from firmware_sim.plants.stability_lobes import depth_limit
from firmware_sim.plants.tooth_cut import ToolMode
from tests.firmware_sim import tooth_runs
from tests.firmware_sim.tooth_runs import RATE

MODE = 400.0, 0.01, 2e6
STILL = 1e13


@pytest.mark.parametrize(("along", "turn"), [(True, 28), (True, 16), (False, 17), (False, 9)])
def test_it_is_a_little_below_the_limit_of_the_periodic_equation(along: bool, turn: int) -> None:
    """A mean over half a turn leaves out how the direction changes within: 0.85 to 1 of the limit in these slots."""
    stiffness = (MODE[2], STILL) if along else (STILL, MODE[2])
    mode = ToolMode((MODE[0],) * 2, (MODE[1],) * 2, stiffness)
    found = depth_limit(mode, 6e8, 1 / 3, 2, RATE / turn)
    assert 0.85 < found / tooth_runs.depth_limit(MODE, RATE / turn, along) < 1.0


def test_it_is_proportional_to_the_stiffness_and_to_nothing_that_turns_the_tool() -> None:
    soft, stiff = (ToolMode((400.0, 430.0), (0.02, 0.03), (each, 1.5 * each)) for each in (1e6, 3e6))
    limits = [depth_limit(each, 6e8, 0.3, 3, 110.0) for each in (soft, stiff)]
    assert limits[1] == pytest.approx(3.0 * limits[0], rel=1e-9)
    turned = ToolMode(soft.frequency[::-1], soft.damping[::-1], soft.stiffness[::-1])
    assert depth_limit(turned, 6e8, 0.3, 3, 110.0) == pytest.approx(limits[0], rel=1e-6)


def test_a_tool_without_a_mode_that_answers_never_chatters() -> None:
    assert np.isinf(depth_limit(ToolMode((5.0, 5.0), (0.9, 0.9), (2e6, 2e6)), 6e8, 0.3, 4, 600.0))
