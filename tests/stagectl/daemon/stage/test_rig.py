"""The stage's procedures under the daemon: followed, stopped, faulty and acknowledged, in process."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.experiment.kept import told
from rigkit.growing_wav import GROWING
from rigkit.run_folder import SUMMARY
from rigkit.service.reload import Reach
from rigkit.service.state import State
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import RECORDING
from stagectl.experiments.piezo.run_setup import setup_of
from stagectl.models.model_file import read_model, write_model
from tests.contract import monitoring
from tests.contract.monitoring import missing_of
from tests.rigkit.service.described import views_are_described
from tests.stagectl.daemon.bench import Lab, edit, lab_in
from tests.stagectl.experiments.piezo.stage_runs import recording_of, replay
from tests.until import until


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    made = lab_in(tmp_path, "daemon.faults=true")
    yield made
    made.close()


def read_summary(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((path / SUMMARY).read_text())
    return found


def replays(path: Path) -> bool:
    return all(each.identical for each in replay(path))


def test_a_reference_is_followed_shown_recorded_and_reported_and_the_rig_stays_armed(lab: Lab) -> None:
    time = np.arange(1_000) / 1_000.0
    wanted = 225e-6 + 20e-6 * np.column_stack([np.sin(2 * np.pi * 3 * time)] * 3)
    recording.write(lab.data / "wave.csv", Recording(("x", "y", "z"), ("m",) * 3, 1_000.0, wanted))
    lab.begin(reference="wave.csv", seconds=1.0)
    lab.until_follows()
    voltage, drive = lab.gauge("voltage_x"), lab.gauge("drive_x")
    assert (voltage.low, voltage.high, drive.is_output) == (0.0, 1000.0, True)
    assert lab.gauge("position_x").high == 430e-6
    assert views_are_described(lab.control)["recording"]
    assert missing_of(lab.control, monitoring.RIG, monitoring.STAGE, monitoring.SIMULATED) == set()
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert views_are_described(lab.control)["panels"] == lab.control.board.revisions()
    path = lab.run_folder()
    assert (path / "report.html").is_file()
    assert replays(path)
    figures = read_summary(path)
    assert figures["seconds"] == 1.0
    assert all(figures["position_error"][axis]["peak"] < 3e-6 for axis in "xyz")
    assert [event["run"] for event in lab.events("finished")] == ["one"]
    panels = lab.control.board
    assert set(panels.revisions()) == {"histogram", "spectrum"}
    shown = panels.panel("histogram")["traces"]
    assert all(np.sum(trace["y"]) == pytest.approx(1.0) for trace in shown)
    means = ", ".join(f"{axis} {1e6 * figures['position_error'][axis]['mae']:.3f}" for axis in "xyz")
    assert panels.panel("histogram")["title"].endswith(f"MAE {means} µm")  # its last second is the whole of it
    assert [gauge.name for gauge in lab.rig.gauges()] == ["disk_free"]


@pytest.mark.slow
def test_a_reference_is_held_where_it_comes_to_a_stop_and_goes_on_and_the_run_replays(lab: Lab) -> None:
    time = np.arange(1_500) / 1_000.0
    wanted = 225e-6 + 20e-6 * np.column_stack([np.sin(2 * np.pi * 2 * time)] * 3)
    recording.write(lab.data / "wave.csv", Recording(("x", "y", "z"), ("m",) * 3, 1_000.0, wanted))
    lab.begin(reference="wave.csv", seconds=1.5)
    lab.until_follows()
    lab.control.hold(lab.key, "look")
    assert lab.state is State.HOLD
    until(lambda: lab.events("held"))
    growing = lab.run_folder() / f"{RECORDING}{GROWING}"
    size = growing.stat().st_size
    until(lambda: growing.stat().st_size > size + 500_000)  # 0.3 s
    lab.control.resume(lab.key, "all is well")
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    path = lab.run_folder()
    made = setup_of(path)
    assert made.held > 2_500 + 2_000
    assert replays(path)
    record = recording_of(path)
    assert len(record.data) == made.timeline.total
    asked = record.select(["wanted_x"]).data[:, 0]
    proper = asked[made.timeline.proper]
    assert np.sum(np.diff(proper) == 0.0) > 2_500
    assert np.abs(np.diff(proper[:-20], 2)).max() < 2e-9  # it comes to a stop, and goes on, without a jump of speed
    figures = read_summary(path)
    assert figures["seconds"] == pytest.approx(1.5 + made.held / 10_000.0)
    assert all(figures["position_error"][axis]["peak"] < 3e-6 for axis in "xyz")


def test_a_stop_takes_the_stage_to_mid_travel_and_keeps_what_has_come(lab: Lab) -> None:
    lab.begin("hold", seconds=100.0, position=[300e-6])
    lab.until_follows()
    lab.control.stop("Ada", "smoke")
    assert lab.state is State.DISARMED
    lab.ended()
    path = lab.run_folder()
    record = recording_of(path)
    voltage = record.select(["voltage_x", "voltage_y", "voltage_z"]).data
    assert voltage[-2_000:].max() > 550.0  # it was away from rest when it was told
    np.testing.assert_array_equal(voltage[-1], 500.0)
    assert np.abs(np.diff(voltage, axis=0)).max() <= 15.0 + 1e-9
    assert replays(path)
    assert not (path / "report.html").exists()
    assert [event["why"] for event in lab.events("end")][-1].endswith("the recording is stored")


def test_a_sensor_that_fails_is_a_fault_with_its_reason_until_a_person_has_acknowledged(lab: Lab) -> None:
    lab.begin("hold", seconds=100.0, position=[300e-6])
    lab.until_follows()
    lab.control.inject(lab.key, "position_y", "nan")
    lab.ended()
    assert lab.state is State.FAULT
    assert "position 2 is not a number" in lab.why
    record = recording_of(lab.run_folder())
    np.testing.assert_array_equal(record.select(["voltage_x"]).data[-1], 500.0)
    assert replays(lab.run_folder())
    assert told(lab.run_folder(), "ended")[""]["reason"] == lab.why
    lab.control.acknowledge(lab.key, "the cable was loose")
    assert lab.state is State.DISARMED
    lab.control.inject(lab.key, "position_y", "none")
    lab.begin("hold", run="two", seconds=0.1)
    lab.ended()
    assert lab.state is State.ARMED, lab.why


def test_nothing_is_followed_without_models_or_with_other_inner_loops_than_theirs(lab: Lab) -> None:
    (lab.data / "stage-y.h5").rename(lab.data / "elsewhere.h5")
    lab.begin("hold")
    lab.ended()
    assert "stage-y.h5 is missing: the procedure calibrate, or `calibrate stage --out " in lab.why
    assert lab.state is State.ARMED
    (lab.data / "elsewhere.h5").rename(lab.data / "stage-y.h5")
    (lab.data / "stage.toml").write_text("[inner]\ngain = [6.5e-8, 6.1e-8, 6.5e-8]\n")
    lab.begin("hold")
    lab.ended()
    assert "[inner] is not what the models were measured with: axis y has Pid(" in lab.why
    assert "start the daemon with that file as --config" in lab.why
    assert not lab.run_folder().exists()


def test_models_of_a_stage_that_was_wired_otherwise_are_followed_once_the_key_is_accepted(lab: Lab) -> None:
    text = rig_file.dump(StageConfig.model_validate({"rig": {"name": "another"}}))
    for file in lab.data.glob("stage-?.h5"):
        write_model(file, replace(read_model(file), provenance={"config": text}))
    lab.begin("hold", seconds=0.1)
    lab.ended()
    assert lab.state is State.ARMED
    assert "stage-x.h5 was measured on a stage that was wired otherwise: rig.name was " in lab.why
    assert not lab.run_folder().exists()
    lab.begin("hold", seconds=0.1, accept=["rig.name"])
    lab.ended()
    assert (lab.state, len(lab.events("finished"))) == (State.ARMED, 1), lab.why
    assert [entry["text"].rsplit("; ")[-1] for entry in lab.events("note")] == ["accepted"] * 3


def test_a_place_outside_the_travel_is_refused(lab: Lab) -> None:
    lab.begin("hold", position=[500e-6])
    lab.ended()
    assert "must be 1 or 3 numbers within limits.travel 2e-05 to 0.00043 m" in lab.why
    assert not lab.run_folder().exists()


def test_a_reload_says_what_holds_when(lab: Lab) -> None:
    lab.control.arm(lab.key, "a test")
    edit(lab.file, lab.data, "daemon.faults=true", "session.seconds=7", "outer.reach=150")
    change = lab.rig.reload()
    assert change.keys == {"session.seconds": Reach.PARAMETERS, "outer.reach": Reach.GRAPH}
    assert change.done == "from the next run on; the rest when it is armed again"
    edit(lab.file, lab.data, "daemon.data=elsewhere")
    with pytest.raises(ValueError, match=r"daemon.data cannot change"):
        lab.rig.reload()


def test_faults_on_purpose_are_refused_for_a_live_stage(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"daemon.faults is true, must be false with session.live"):
        lab_in(tmp_path, "daemon.faults=true", "session.live=true")


def test_a_reload_takes_no_code_that_the_daemon_was_not_started_with(lab: Lab) -> None:
    edit(lab.file, lab.data, "link.bus=os:system")
    with pytest.raises(ValueError, match="link.bus is 'os:system', must be code that the daemon was started with"):
        lab.control.reload(lab.key)
