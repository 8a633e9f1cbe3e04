"""The stage calibrated under the daemon: its models and loops are in force from then on."""

from pathlib import Path

import pytest

from calibration.stage_axes import order
from rigkit import config as rig_file
from rigkit.service.state import State
from stagectl.config import StageConfig
from stagectl.models.model_file import read_model
from stagectl.stage import design_refinement
from tests.calibration.stage_axes.test_command import QUICK
from tests.stagectl.daemon.bench import Lab, lab_in
from tests.until import until


def calibrated(lab: Lab) -> None:
    lab.control.begin(lab.key, "calibrate", {"axis": "z"}, "")


@pytest.mark.slow
def test_a_calibration_is_stopped_goes_on_and_what_it_chooses_is_in_force(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(order, "MOST", 5)  # to be quick
    monkeypatch.setattr(design_refinement, "LOOKS", 20)
    monkeypatch.setattr("rigkit.report._rendered", lambda *_: b"")
    lab = lab_in(tmp_path, *QUICK)
    for model in lab.data.glob("stage-*.h5"):
        model.unlink()
    lab.control.arm(lab.key, "a test")
    calibrated(lab)
    until(lambda: any((lab.data / "stage.raw").glob("*.wav")))
    assert lab.state is State.CALIBRATING
    lab.control.stop("Ada", "smoke")
    lab.ended()
    kept = {file: file.stat().st_mtime_ns for file in (lab.data / "stage.raw").glob("*.wav")}
    assert 1 <= len(kept) < 8
    assert not (lab.data / "stage-z.h5").exists()
    lab.control.arm(lab.key, "a test")
    calibrated(lab)
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert all(file.stat().st_mtime_ns == time for file, time in kept.items())
    assert read_model(lab.data / "stage-z.h5", rate=5000.0).is_stable
    chosen = rig_file.load(lab.data / "stage.toml", StageConfig)
    assert lab.rig.config.inner == chosen.inner
    assert chosen.inner.gain[2] != chosen.inner.gain[0]
    assert {"models", "inner", "outer", "response"} <= set(lab.control.board.revisions())
    assert len(lab.control.board.panel("models")["rows"]) == 5
    (trace,) = lab.control.board.panel("response")["traces"]
    assert trace["name"] == "z"
    lab.close()
