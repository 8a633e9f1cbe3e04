"""Milling models go into their file and come back; what is no such file is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigkit.model_file import ModelFileError
from stagectl.robot.milling.convergence import cautious
from stagectl.robot.milling.learning import PathLaw
from stagectl.robot.milling.milling_models import MillingModels, Process, RobotModel, read_milling, write_milling
from tests.stagectl.robot.milling.trial_models import RATE, axis, process

FREQUENCY = np.linspace(0.5, 25.0, 40)


def models(with_estimated: bool = True) -> MillingModels:
    axes = axis(2), axis(3, 0.3), axis(2, -0.5)
    measured = np.stack([each.response(FREQUENCY) for each in axes], axis=-1)
    robot = RobotModel(axes, FREQUENCY, measured, np.full((40, 3), 0.01), np.array([95.0, 94.0, 93.0]))
    milled = process()
    slow = np.linspace(0.0, 25.0, 50)
    part = Process(
        milled, np.array([50.0, 40.0, 10.0]), np.array([94.0, 93.0, 87.0]), slow, 1.1 * milled.coupling(slow)
    )
    parts = {"measured": part, "estimated": part} if with_estimated else {"measured": part}
    return MillingModels({"motors": robot, "tool": robot}, parts, 2e-3, {}, {"made": "today"})


@pytest.mark.parametrize("with_estimated", [True, False])
def test_all_comes_back(tmp_path: Path, with_estimated: bool) -> None:
    before = models(with_estimated)
    write_milling(tmp_path / "milling.h5", before, {})
    again = read_milling(tmp_path / "milling.h5")
    assert list(again.process) == list(before.process)
    assert (again.depth, again.provenance) == (2e-3, {"made": "today"})
    for here, there in zip(before.robot["tool"].axes, again.robot["tool"].axes, strict=True):
        assert np.array_equal(here.response(FREQUENCY), there.response(FREQUENCY))
    here, there = (each.process["measured"] for each in (before, again))
    assert np.array_equal(here.model.coupling(FREQUENCY), there.model.coupling(FREQUENCY))
    assert np.array_equal(here.other, there.other)
    assert again.doubt("tool", "measured").coupling is not None
    assert again.doubt("tool", None).coupling is None
    assert here.model.force.rate == RATE


def test_another_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "milling.h5").write_bytes(b"no model")
    with pytest.raises(ModelFileError, match="not a readable model file"):
        read_milling(tmp_path / "milling.h5")


def test_where_the_tracker_tells_nothing_of_the_tool_it_goes_as_the_motors_do() -> None:
    """Chirps hardly move it at their lowest frequencies: learning is not given up there, nor a mode overlooked."""
    found = models()
    robot = found.robot["tool"]
    response, spread = 1.7 * robot.response, np.array(robot.spread)
    response[:3, 2], spread[:3, 2] = 0.3, 1.8
    unsure = replace(found, robot={**found.robot, "tool": replace(robot, response=response, spread=spread)})
    doubt = unsure.doubt("tool", None)
    assert np.array_equal(doubt.robot[:3, 2], robot.response[:3, 2])
    assert np.array_equal(doubt.spread[:3, 2], robot.spread[:3, 2])
    assert np.array_equal(doubt.robot[3:], response[3:])
    law = PathLaw(robot.axes)
    assert cautious(law, doubt).passed(FREQUENCY[:3]).min() > 0.5
    assert cautious(law, replace(doubt, robot=response, spread=spread)).passed(FREQUENCY[:3]).max() < 0.1
