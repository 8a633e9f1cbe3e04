"""Logs of other clocks and rates become a trial's signals; what is missing or has gaps is refused by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stagectl.experiments.trials.command import learn_from_logs, wanted_methods
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.log_folder import ANGLES, FORCES, POSITION, TORQUES, LogFolder, read_log, write_path
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.milling.lost_motion import LostMotion
from stagectl.robot.milling.milling_models import MillingModels
from stagectl.robot.milling.zero_phase import filtered
from tests.stagectl.experiments.trials.short_trial import small
from tests.stagectl.robot.milling.test_milling_models import models

RATE = 250.0
OFFSET = np.array([2e-4, -1e-4, 3e-4])


@pytest.fixture(scope="module")
def first() -> Trial:
    return small()


@pytest.fixture(scope="module")
def known() -> MillingModels:
    return models()


def write(path: Path, time: np.ndarray, names: tuple[str, ...], values: np.ndarray) -> None:
    rows = [",".join(f"{each:.9g}" for each in row) for row in np.column_stack([time, values])]
    path.write_text("\n".join([",".join(["time [s]", *names]), *rows]) + "\n", encoding="utf-8")


def logged(folder: Path, trial: Trial, known: MillingModels, gap: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Write the logs of a linear robot, its clock 3.2 s ahead and the tracker's 1.1 s behind; return y_r."""
    folder.mkdir(parents=True, exist_ok=True)
    axes = known.robot["motors"].axes
    answer = filtered(
        trial.sent, RATE, lambda f: np.stack([each.response(f) for each in axes], axis=-1)[..., None] * np.eye(3)
    )
    time = np.arange(len(answer)) / RATE
    write_path(folder / "sent.csv", trial.sent, trial.joints)
    angle = trial.path.joints(trial.arm, answer)
    keep = ~((time > gap[0]) & (time < gap[1]))
    write(folder / "robot.csv", time[keep] + 3.2, (*ANGLES, *TORQUES), np.hstack([angle, 0 * angle])[keep])
    write(folder / "force.csv", time + 3.2, FORCES, 0 * answer)
    seen_at = np.arange(0.0, time[-1], 1 / 440.0)
    seen = np.stack([np.interp(seen_at, time, each) for each in answer.T], axis=-1)
    write(folder / "tracker.csv", seen_at - 1.1, POSITION, trial.path.origin(trial.arm) + seen + OFFSET)
    return answer


def test_clocks_are_brought_together(tmp_path: Path, first: Trial, known: MillingModels) -> None:
    answer = logged(tmp_path, first, known)
    found = LogFolder(tmp_path, first, known.robot["motors"].axes)
    found.touch_off()
    signals = found.signals(True, True)
    assert np.array_equal(signals.sent, first.sent)
    assert signals.joints == pytest.approx(answer, abs=1e-6)
    assert signals.seen is not None
    assert signals.seen[400:-200] == pytest.approx(answer[400:-200] + (first.sent[0] - answer[0]), abs=3e-6)


@pytest.mark.parametrize(("carries", "is_denied"), [(True, True), (False, False)])
def test_lost_motion_that_the_tracker_denies_in_the_air_is_taken_out_of_the_next_path(
    tmp_path: Path, first: Trial, known: MillingModels, carries: bool, is_denied: bool
) -> None:
    """The links of a robot without backlash; a path that carries none, or is learned already, is not judged."""
    notes, paths = list[str](), list[np.ndarray]()
    lost = LostMotion(np.array([3e-4, 0, 0, 0, 0, 0]))
    carried = Learner(first.cell, known, lost=lost).carried(first)
    played = replace(first, sent=first.sent + carried) if carries else first
    for folder in (tmp_path, tmp_path / "free"):
        logged(folder, played, known)
    for each in (None, lost):
        file = learn_from_logs(tmp_path, first, Learner(first.cell, known, lost=each, note=notes.append), 1)
        paths.append(np.stack(list(read_log(file, POSITION).values())[1:], axis=1))
    assert [note.split(": the tracker saw")[0] for note in notes] == [str(tmp_path / "free")] * is_denied
    left = np.abs(paths[0] - paths[1])
    assert bool(left.max() > 1e-6) is is_denied
    assert left.max() < np.abs(carried).max()


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("method", [1, 2])
def test_an_iteration_from_logs_writes_a_path_that_takes_the_lag_away(
    tmp_path: Path, first: Trial, known: MillingModels, method: int
) -> None:
    answer = logged(tmp_path, first, known)
    logged(tmp_path / "free", first, known)
    learner = Learner(first.cell, known)
    file = learn_from_logs(tmp_path, first, learner, method)
    sent = np.stack([read_log(file, POSITION)[name] for name in POSITION], axis=-1)
    axes = known.robot["motors"].axes
    again = filtered(
        sent, RATE, lambda f: np.stack([each.response(f) for each in axes], axis=-1)[..., None] * np.eye(3)
    )
    before, after = (np.abs(first.path.wanted - each)[first.path.milled].mean() for each in (answer, again))
    assert after < 0.35 * before
    assert len(read_log(file, ANGLES)["angle_1"]) == first.path.samples


def test_a_log_with_a_gap_is_refused_by_place(tmp_path: Path, first: Trial, known: MillingModels) -> None:
    logged(tmp_path, first, known, gap=(2.0, 2.3))
    with pytest.raises(ValueError, match=r"robot.csv: there is no sample for 0.3\d* s from 5.2 s on, must be"):
        LogFolder(tmp_path, first, known.robot["motors"].axes)


def test_method_3_without_torques_is_refused(tmp_path: Path, first: Trial, known: MillingModels) -> None:
    logged(tmp_path, first, known)
    table = (tmp_path / "robot.csv").read_text(encoding="utf-8").splitlines()
    (tmp_path / "robot.csv").write_text("\n".join(",".join(row.split(",")[:7]) for row in table), encoding="utf-8")
    found = LogFolder(tmp_path, first, known.robot["motors"].axes)
    with pytest.raises(ValueError, match="has no column torque_1"):
        _ = found.torques
    with pytest.raises(ValueError, match="method 2 needs the logs of an air cut"):
        learn_from_logs(tmp_path, first, Learner(first.cell, known), 2)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,x,y\n0,1,2\n", "there is no column z; there are time, x, y"),
        ("time,x,y,z\n0,1,2,3\n1,2,three,4\n", "line 3 is 1,2,three,4, must be numbers under time, x, y, z"),
    ],
)
def test_a_file_that_is_no_log_is_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "tracker.csv").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=words):
        read_log(tmp_path / "tracker.csv", POSITION)


def test_methods_are_read_one_several_or_all() -> None:
    assert [wanted_methods(text) for text in ("2", "1,3", "all")] == [(2,), (1, 3), (1, 2, 3)]
    with pytest.raises(ValueError, match="method is '4', must be 1, 2, 3"):
        wanted_methods("4")
