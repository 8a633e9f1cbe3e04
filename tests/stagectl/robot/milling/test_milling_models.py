"""Milling models go into their file and come back; what is no such file is refused."""

from pathlib import Path

import numpy as np
import pytest

from rigkit.model_file import ModelFileError
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
