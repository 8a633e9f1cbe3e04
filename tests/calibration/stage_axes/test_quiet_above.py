"""How what lies above a model's band bounds the loop."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from calibration.stage_axes.bench import left_alone
from calibration.stage_axes.calibration import ANSWER, SMALL, Closed, inner_loop, quiet_above
from rigkit import config as rig_file
from stagectl.config import Outer, StageConfig
from tests.stagectl.linear_stage import model

AT_REST = abs(model("z").frequency_response(np.zeros(1))[0, 0, 0])


def closed(above: float, seen: float | None) -> Closed:
    told = SimpleNamespace(
        one=SimpleNamespace(model=model("z")), above=above * AT_REST, seen=None if seen is None else seen * AT_REST
    )
    return cast(Closed, told)


def test_a_stage_that_is_silent_there_keeps_the_bounds_of_its_rig_file() -> None:
    found = quiet_above(Outer(), 2, closed(1e-3, 1e-3))
    assert found.beyond == Outer().beyond
    assert found.forward_beyond == Outer().forward_beyond


def test_where_noise_alone_is_seen_there_the_rig_files_bounds_hold() -> None:
    found = quiet_above(Outer(), 2, closed(0.0, 0.0))
    assert (found.beyond, found.forward_beyond) == (Outer().beyond, Outer().forward_beyond)


def test_one_that_rings_there_gets_a_loop_of_small_gain() -> None:
    found = quiet_above(Outer(), 2, closed(4.0, None))
    assert found.beyond == (pytest.approx(SMALL / 4.0, rel=1e-2),)
    assert found.forward_beyond == pytest.approx(ANSWER / 4.0)


def test_what_a_laser_sees_otherwise_than_the_plates_sensor_bounds_the_answer_to_a_reference() -> None:
    assert quiet_above(Outer(), 2, closed(4.0, 0.2)).forward_beyond == pytest.approx(SMALL / 0.2)


def test_an_inner_loop_is_so_slow_that_its_gain_is_small_there() -> None:
    rig = rig_file.load(None, StageConfig, [])
    stack = model("z")
    _, as_wished, _ = inner_loop(rig, 2, stack)
    _, slowed, _ = inner_loop(rig, 2, stack, above=SMALL * AT_REST / 0.1)
    assert slowed.bandwidth[0] <= 0.1 < as_wished.bandwidth[0]


def test_nothing_is_milled_while_an_axis_is_excited() -> None:
    milled = rig_file.load(None, StageConfig, ["simulator.surroundings=firmware_sim.stage_blocks:Milling"])
    assert left_alone(milled).simulator.surroundings == StageConfig().simulator.surroundings
    assert left_alone(milled).simulator.plant == milled.simulator.plant
