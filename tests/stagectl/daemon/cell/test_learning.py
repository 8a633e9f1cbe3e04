"""Trials under the daemon: paused between two, stopped in the material, gone on with, and ended by a fault."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from rigkit import config as rig_file
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, records_of
from rigkit.run_folder import CONFIG, RunFolder
from rigkit.service.state import State
from stagectl.experiments.trials.asked import Asked
from stagectl.experiments.trials.bench import SimulatedBench
from stagectl.experiments.trials.campaign import grouped
from stagectl.experiments.trials.done import DoneTrial, done_trial
from stagectl.experiments.trials.read_back import TRIALS, Files, read_back, task_of
from stagectl.experiments.trials.trial import cell_for_task, first_trial
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import write_milling
from tests.stagectl.daemon.bench import Lab
from tests.stagectl.daemon.cell.bench import cell_in
from tests.stagectl.models.test_joint_backlash import written
from tests.stagectl.robot.milling.test_milling_models import models
from tests.until import until

ILC = {"task": "pocket", "iterations": 1}


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    made = cell_in(tmp_path)
    yield made
    made.close()


def done(lab: Lab) -> float:
    """Return how many trials of those to be run are done."""
    seconds = first_trial(rig_file.load(lab.file, CellConfig), "pocket").path.seconds
    return 0.0 if lab.control.desk is None else float(lab.control.desk.plain()["done"]) / seconds


def whole(path: Path) -> list[DoneTrial]:
    """Return the trials of a run that came to their end."""
    records = records_of(path)
    return read_back(path, records).whole(records)


@pytest.mark.slow
def test_trials_pause_between_two_and_a_stop_in_the_air_ends_one_that_replays(lab: Lab) -> None:
    lab.begin("ilc", **ILC)
    until(lambda: done(lab) > 0.2)
    assert {lab.gauge(name).verdict for name in ("tool_x", "joint_speed_2", "tracker_age")} == {"good"}
    assert lab.gauge("tool_speed").is_output
    lab.control.hold(lab.key, "a fresh block")
    until(lambda: lab.events("held"))
    assert [event["before"] for event in lab.events("held")] == ["free-1"]
    assert {gauge.name: gauge.value for gauge in lab.rig.gauges() if gauge.name != "disk_free"} == {"tool_speed": 0.0}
    assert lab.state is State.HOLD
    lab.control.resume(lab.key, "it is in")
    until(lambda: done(lab) > 1.3)
    lab.control.stop("Ada", "smoke")
    assert lab.state is State.DISARMED
    lab.ended()
    path = lab.run_folder()
    assert [each.name for each in whole(path)] == ["free-0"]
    retreating = recording.read(path / "free-1-trial.wav").select(["retreating"]).data
    assert retreating[-1] == 1.0
    assert all(each.identical for each in replayed(path, TRIALS))
    assert "Ended early, free-1" in (path / "report.html").read_text()


@pytest.mark.slow
def test_a_stop_lifts_the_tool_out_of_the_material_and_the_run_goes_on_to_its_last_trial(lab: Lab) -> None:
    lab.begin("ilc", **ILC)
    until(lambda: done(lab) > 2.4)
    assert lab.gauge("force").value > 1.0
    lab.control.stop("Ada", "smoke")
    lab.ended()
    path = lab.run_folder()
    trial = done_trial("milled-0", records_of(path), first_trial(*task_of(path))).trial
    assert trial.block is not None
    height = recording.read(path / "milled-0-truth.wav").select(["position_z"]).data[:, 0] - trial.block[2]
    assert height.min() < -1e-4
    assert height[-1] == pytest.approx(3e-4, abs=1.5e-4)

    lab.begin("ilc", resume=True, iterations=1)
    until(lambda: done(lab) > 0.4)
    lab.control.abort(lab.key, "enough")
    lab.ended()
    assert lab.state is State.ARMED
    assert whole(path)[-1].name == "milled-0"  # that trial came to its end
    assert (path / "before-1" / "milled-0-trial.wav").is_file()
    lab.begin("ilc", resume=True, iterations=1)
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    free, learned = grouped(whole(path))
    assert [each.name for each in free] == ["free-0", "free-1"]
    sizes = [float(np.linalg.norm(each.mae)) for each in learned[1]]
    assert sizes[1] < 0.6 * sizes[0]
    assert all(each.identical for each in replayed(path, TRIALS))
    assert (path / "report.html").is_file()
    panels = lab.control.board
    shown = {trace["name"]: trace["y"] for trace in panels.panel("convergence")["traces"]}
    assert shown["norm"] == pytest.approx(sizes)
    assert {"path", "error", "free_space", "trials", "force", "cutting_force_x"} <= set(panels.revisions())
    assert len(panels.panel("trials")["rows"]) == 4


def test_joint_models_are_kept_with_the_run_whose_path_carries_their_lost_motion(lab: Lab) -> None:
    weightless = replace(models(), torques={"gravity/moments": np.zeros((6, 4))})
    write_milling(lab.data / "milling.h5", weightless, {"gravity/moments": "kg m"})
    written(lab.data / "joints.h5", [(2e-4, 1e-5)] * 6, rig_file.load(lab.file, CellConfig))
    lab.begin("ilc", joints="joints.h5", **ILC)
    until(lambda: done(lab) > 0.0)
    lab.control.stop("Ada", "enough")
    lab.ended()
    assert (lab.run_folder() / "joints.h5").read_bytes() == (lab.data / "joints.h5").read_bytes()


@pytest.mark.slow
def test_a_blind_tracker_is_a_fault_with_its_reason(tmp_path: Path) -> None:
    lab = cell_in(tmp_path, "plants.tracker_options.blind=1.6", "plants.tracker_options.blind_for=9.0")
    lab.begin("ilc", **ILC)
    lab.ended()
    assert lab.state is State.FAULT
    assert lab.why.startswith("free-0: the tracker is blind for 0.05")
    assert lab.events("retreat")
    lab.control.acknowledge(lab.key, "an LED was covered")
    assert lab.state is State.DISARMED
    assert (lab.run_folder() / "free-0-trial.wav").is_file()
    lab.close()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"model": "other.h5"}, "model is 'other.h5', must be a file in the data folder, "),
        ({"resume": True}, "run is 'one', where no trials are in"),
    ],
)
def test_what_cannot_be_begun_leaves_no_folder(lab: Lab, options: dict[str, object], words: str) -> None:
    lab.begin("ilc", **{**ILC, **options})
    lab.ended()
    assert lab.state is State.ARMED
    assert lab.why.startswith(f"Learn to mill has not begun: {words}")
    assert not lab.run_folder().exists()


@pytest.mark.slow
def test_trials_of_which_the_settings_were_edited_since_go_on_once_the_key_is_accepted(lab: Lab) -> None:
    path = lab.run_folder()
    cell = cell_for_task(rig_file.load(lab.file, CellConfig), "pocket")
    files = Files("pocket", Path(cell.daemon.data) / "milling.h5")
    create(path, TRIALS, cell, Asked((1,), 1, SimulatedBench()).new(cell, files), files.take_into).close()
    edited = rig_file.load(path / CONFIG, CellConfig, ("learning.free=2",), as_written=True)
    (path / CONFIG).write_text(rig_file.dump(edited))
    lab.begin("ilc", resume=True, iterations=1)
    lab.ended()
    assert lab.state is State.ARMED
    assert f"{path}/ has changed since the run began: learning.free was 1, is 2" in lab.why
    assert not list(path.glob("free-*"))
    RunFolder.open(path).close()  # which nobody holds
    lab.begin("ilc", resume=True, iterations=1, accept=["learning.free"], paced=True)
    until(lambda: lab.events("note") and done(lab) > 0.0)
    lab.control.stop("Ada", "enough")
    lab.ended()
    assert lab.events("note")[0]["text"].endswith("learning.free was 1, is 2; accepted")
