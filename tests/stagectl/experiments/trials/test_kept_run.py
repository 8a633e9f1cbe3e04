"""A run of trials in its folder: killed, gone on with, refused, and read where the version before has written it.

Guards against a trial that is milled twice in material, against recordings that a kill takes along, and against folders
that a lab has and that can no longer be read.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import records_of
from rigkit.run_folder import read_events
from stagectl.application import PROGRAM
from stagectl.experiments.trials.done import BESIDE, DoneTrial
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.log_folder import POSITION, read_log
from stagectl.experiments.trials.read_back import TRIALS, read_back
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.lost_motion import LostMotion
from stagectl.robot.milling.milling_models import write_milling
from tests.stagectl.experiments.trials.short_trial import SMALL
from tests.stagectl.models.test_joint_backlash import written
from tests.stagectl.robot.milling.test_milling_models import models
from tests.until import until

SETTINGS = [word for each in (*SMALL, "pocket.feed=25e-3", "learning.free=1") for word in ("--set", each)]
NAMES = ["free-0", "free-1", "milled-0", "method-1-1"]


def _run(*arguments: str) -> None:
    PROGRAM.only(arguments[0])(list(arguments), standalone_mode=False)


def _new(model: Path, path: Path) -> list[str]:
    return ["ilc", "--model", str(model), "--task", "pocket", "--iterations", "1", "--out", str(path), *SETTINGS]


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Kill a run in the material."""
    place = tmp_path_factory.mktemp("killed")
    write_milling(place / "models.h5", models(), {})
    words = [sys.executable, "-m", "stagectl", *_new(place / "models.h5", place / "run")]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
        file = place / "run/milled-0-trial.part.wav"
        until(lambda: (file.exists() and os.stat(file).st_size > 100_000) or program.poll() is not None)
        program.send_signal(signal.SIGKILL)
    assert program.returncode == -signal.SIGKILL
    return place / "run"


@pytest.fixture
def path(killed: Path, tmp_path: Path) -> Path:
    shutil.copytree(killed, tmp_path / "run", ignore=shutil.ignore_patterns(".lock"))
    return tmp_path / "run"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("whole")
    write_milling(place / "models.h5", models(), {})
    _run(*_new(place / "models.h5", place / "run"))
    return place / "run"


def _trials(path: Path) -> list[DoneTrial]:
    records = records_of(path)
    return read_back(path, records).whole(records)


def test_of_the_trial_under_way_all_but_the_last_moments_are_kept(path: Path) -> None:
    _run("report", str(path))
    assert [each.name for each in _trials(path)] == NAMES[:2]
    kept = recording.read(path / "milled-0-trial.wav")
    assert len(kept.data) > 125
    again = {each.recording: each.identical for each in replayed(path, TRIALS)}
    assert set(again) == {f"{name}-{part}" for name in NAMES[:3] for part in ("trial", "tracker")}
    assert all(again.values())
    assert "Ended early, milled-0" in (path / "report.html").read_text()


@pytest.mark.slow
def test_what_is_left_is_run_as_if_nothing_had_happened(path: Path, whole: Path) -> None:
    _run("ilc", "--resume", str(path))
    assert [each.name for each in _trials(path)] == NAMES
    assert (path / "before-1/milled-0-trial.wav").is_file()
    for name in NAMES:
        here, there = (recording.read(each / f"{name}-trial.wav").data for each in (path, whole))
        assert here.tobytes() == there.tobytes()
    assert [each["part"] for each in read_events(path) if each["event"] == "started"] == [*NAMES[:3], *NAMES[2:]]
    with pytest.raises(ValueError, match="nothing is left of it: free-0, free-1, milled-0, method-1-1 came to their"):
        _run("ilc", "--resume", str(path))
    _run("ilc", "--resume", str(path), "--iterations", "2")
    assert [each.name for each in _trials(path)] == [*NAMES, "method-1-2"]


def test_a_run_whose_models_were_changed_is_not_gone_on_with(path: Path) -> None:
    with (path / "milling.h5").open("ab") as file:
        file.write(b"another")
    with pytest.raises(ValueError, match="has changed since the run began: milling.h5"):
        _run("ilc", "--resume", str(path))
    assert not (path / "before-1").exists()


@pytest.mark.parametrize(("option", "value"), [("--task", "pocket"), ("--set", "learning.gain=1"), ("--out", "other")])
def test_settings_of_a_new_run_are_refused_for_one_that_is_gone_on_with(path: Path, option: str, value: str) -> None:
    with pytest.raises(ValueError, match=f"{option} and --resume are given"):
        _run("ilc", "--resume", str(path), option, value)


def test_a_replay_takes_no_other_settings(whole: Path) -> None:
    with pytest.raises(ValueError, match="must not be given but for: cell runs, mid-ranging run, "):
        _run("replay", str(whole), "--set", "learning.gain=0.5")


def _as_of_old(run: Path, path: Path) -> None:
    """Write a run as version 0.1.0 did: tables, a path beside each trial, an ended one by its name, no parts told."""
    shutil.copytree(run, path, ignore=shutil.ignore_patterns("*.wav", "events.jsonl", "report.html", ".lock"))
    for each in _trials(run):
        name = f"{each.name}-ended" if each.name == "method-1-1" else each.name
        own = each.records["trial"]
        kept = own.select([channel for channel in own.names if not channel.startswith("sent")])
        about = {"trial": str(each.trial.number), "software": "vibrostage 0.1.0"}
        for part, record in {**each.records, "trial": kept}.items():
            suffix = "wav" if part == "tracker" else "csv"
            bare = Recording(record.names, record.units, record.rate, record.data, about)
            recording.write(path / f"{name}-{part}.{suffix}", bare)
        names = ("sent_x", "sent_y", "sent_z")
        recording.write(
            path / f"{name}-{BESIDE}.csv", Recording(names, ("m",) * 3, own.rate, each.trial.sent, each.trial.about)
        )


def test_a_folder_of_the_version_before_is_reported_and_replayed(
    whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old = tmp_path / "old"
    _as_of_old(whole, old)
    (old / "run.json").unlink()
    _run("report", str(old))
    found, before = (json.loads((each / "summary.json").read_text()) for each in (old, whole))
    assert found["free"] == before["free"]
    assert found["methods"] == {}
    _run("replay", str(old))
    assert "made again: milled-0-tracker" in capsys.readouterr().err
    with pytest.raises(ValueError, match="is of version 0.1.0, must be begun again"):
        _run("ilc", "--resume", str(old))


def test_a_model_of_another_robot_is_refused_before_anything_is_milled(tmp_path: Path) -> None:
    right = models()
    robot = {
        side: replace(each, axes=tuple(replace(axis, numerator=3.0 * np.asarray(axis.numerator)) for axis in each.axes),
                      response=3.0 * each.response)
        for side, each in right.robot.items()
    }  # fmt: skip
    write_milling(tmp_path / "models.h5", replace(right, robot=robot), {})
    with pytest.raises(ValueError, match=r"free-0: along x the motors went 0.33\d* times as far as G_R has it"):
        _run(*_new(tmp_path / "models.h5", tmp_path / "run"))
    assert [each.name for each in _trials(tmp_path / "run")] == ["free-0"]
    assert (tmp_path / "run/report.html").is_file()


def test_the_path_to_play_first_is_that_of_a_run(tmp_path: Path, whole: Path) -> None:
    words = ("ilc", "--path", str(tmp_path / "logs"), "--task", "pocket", *SETTINGS)
    _run(*words)
    written = (tmp_path / "logs/sent.csv").read_text()
    assert written == (whole / "logs/free-0/sent.csv").read_text()
    with pytest.raises(ValueError, match="sent.csv is there already, must be another folder"):
        _run(*words)


def test_the_path_to_play_first_carries_lost_motion(tmp_path: Path, whole: Path) -> None:
    weightless = replace(models(), torques={"gravity/moments": np.zeros((6, 4))})
    write_milling(tmp_path / "models.h5", weightless, {"gravity/moments": "kg m"})
    cell = CellConfig()
    joints = ("--joints", str(written(tmp_path / "joints.h5", [(2e-4, 1e-5)] * 6, cell)))
    words = ("--path", str(tmp_path / "logs"), "--model", str(tmp_path / "models.h5"), "--task", "pocket", *SETTINGS)
    _run("ilc", *words, *joints)
    played = [read_log(folder / "sent.csv", POSITION) for folder in (tmp_path / "logs", whole / "logs/free-0")]
    more = np.stack([played[0][name] - played[1][name] for name in POSITION])
    assert 2e-5 < np.abs(more).max() < 1e-3


def test_lost_motion_that_the_tracker_denies_is_taken_out_of_the_next_path(whole: Path) -> None:
    free, notes = _trials(whole)[0], list[str]()
    learner = Learner(free.trial.cell, models(), note=notes.append, lost=LostMotion(np.array([3e-3, 0, 0, 0, 0, 0])))
    carried = learner.carried(free.trial)
    assert 5e-4 < np.abs(carried).max() < 3e-3
    sent = replace(free.trial, sent=free.trial.path.wanted + carried)
    step = learner.next_path([replace(free, trial=sent)], None)
    left = step.sent - learner.judged(free, step).sent
    assert notes[0].startswith("free-0: the tracker saw the tool off the motors by")
    assert 0.0 < np.abs(left).mean() < 0.2 * np.abs(carried).mean()  # what is slow was learned away
