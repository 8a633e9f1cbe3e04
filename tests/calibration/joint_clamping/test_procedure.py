"""Joints calibrated under the daemon: the map grows on the page, a STOP holds the arm, and it goes on from there."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from calibration.joint_clamping.joints_file import read_joints
from rigkit.service.state import State
from tests.calibration.joint_clamping.test_command import QUICK
from tests.stagectl.daemon.bench import Lab
from tests.stagectl.daemon.cell.bench import cell_in
from tests.until import until


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    made = cell_in(tmp_path, *QUICK)
    yield made
    made.close()


def begin(lab: Lab, **options: object) -> None:
    if lab.state is State.DISARMED:
        lab.control.arm(lab.key, "a test")
    lab.control.begin(lab.key, "calibrate-joints", {"joints": "3", **options}, "")


def shows(lab: Lab, panel: str) -> bool:
    return panel in lab.control.board.revisions()


@pytest.mark.slow
def test_the_map_of_the_joint_that_is_moved_grows_and_ends_with_its_model(lab: Lab) -> None:
    begin(lab, paced=True)
    until(lambda: any(gauge.name == "torque_3" for gauge in lab.rig.gauges()))
    assert lab.state is State.CALIBRATING
    assert (lab.gauge("torque_3").low, lab.gauge("torque_3").high) == (-160.0, 160.0)
    lab.control.stop("Ada", "smoke")
    lab.ended()
    assert lab.state is State.DISARMED
    assert not (lab.data / "joints.h5").exists()
    begin(lab)
    until(lambda: shows(lab, "map_3"))
    growing = lab.control.board.panel("map_3")
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    whole = lab.control.board.panel("map_3")
    measured, spring = whole["traces"]
    assert len(measured["x"]) > 1_000
    assert len(growing["traces"][0]["x"]) <= len(measured["x"])
    assert "backlash" in whole["title"]
    model = read_joints(lab.data / "joints.h5")[2]
    assert lab.events("calibrated")[0]["joint_3"] == model.backlash_said
    slope = np.polyfit(spring["x"], spring["y"], 1)[0]
    assert 0.3 < slope / model.k_plus.value < 1.2  # measured at the motor, it is softer
    assert len(lab.control.board.panel("joints")["rows"]) >= 1


def test_joints_that_the_arm_has_not_are_refused(lab: Lab) -> None:
    begin(lab, joints="3,7")
    lab.ended()
    assert "'7' must be a number or a range from 1 to 6" in lab.why
    assert not (lab.data / "joints.raw").exists()
