"""Milling calibrated under the daemon: stopped in its sweep, gone on with, and learned with afterwards."""

import json
from pathlib import Path

import pytest

from rigkit.experiment.kept import told
from rigkit.experiment.runner import STOPPED
from rigkit.service.state import State
from tests.calibration.milling.test_command import SETTINGS
from tests.stagectl.daemon.cell.bench import cell_in
from tests.until import until


@pytest.mark.slow
def test_a_calibration_is_stopped_goes_on_and_its_models_are_learned_with(tmp_path: Path) -> None:
    lab = cell_in(tmp_path, *SETTINGS, "pocket.feed=10e-3")
    (lab.data / "milling.h5").unlink()
    lab.control.arm(lab.key, "a test")
    lab.control.begin(lab.key, "calibrate-milling", {"task": "pocket"}, "")
    until(lambda: lab.control.desk is not None and lab.control.desk.plain()["done"] > 0.3)
    assert lab.state is State.CALIBRATING
    assert lab.gauge("tool_x").verdict == "good"
    lab.control.stop("Ada", "smoke")
    lab.ended()
    raw = lab.data / "milling.raw"
    assert told(raw, "ended")["sweep"]["reason"] == STOPPED
    assert (raw / "sweep.wav").is_file()
    lab.control.arm(lab.key, "a test")
    lab.control.begin(lab.key, "calibrate-milling", {"task": "pocket"}, "")
    until(lambda: lab.control.settle() or not lab.control.machine.busy)
    assert lab.state is State.ARMED, lab.why
    assert (raw / "before-1" / "sweep.wav").is_file()
    assert {"torque", "error", "path", "free_space", "fits"} <= set(lab.control.board.revisions())
    assert (lab.data / "milling.html").is_file()
    lab.begin("ilc", task="pocket", iterations=1)
    until(lambda: lab.control.settle() or not lab.control.machine.busy)
    assert lab.state is State.ARMED, lab.why
    found = json.loads((lab.run_folder() / "summary.json").read_text())["methods"]["1"]
    assert found[-1]["norm"] < 0.6 * found[0]["norm"]
    lab.close()
