"""Studies over recorded runs: which runs are taken, and what is asked of each."""

from pathlib import Path

import pytest

from rigkit.config import ConfigError
from rigkit.origin import RUN, Origin
from rigkit.study import programs
from rigkit.study.plan import Plan
from vibrostage.replay_study import replay_study


def run(runs: Path, name: str, kind: str = "vibrator run", shots: int = 2) -> Path:
    """Make what is looked at in the folder of a run."""
    place = runs / name
    (place / "shots").mkdir(parents=True)
    for file in ("config.toml", ".lock"):
        (place / file).write_text("")
    for shot in range(shots):
        (place / "shots" / f"{shot:04d}.wav").write_bytes(b"%d" % shot)
    Origin(kind, {}, {}, "vibrostage 1", "2026-01-01").write(place / RUN)
    return place


def test_each_run_of_a_vibrator_is_replayed_and_its_last_shot_judged(tmp_path: Path) -> None:
    place = run(tmp_path, "20260101 harbour")
    run(tmp_path, "stage", kind="stage run")
    run(tmp_path, "empty", shots=0)
    study = replay_study(tmp_path, ["learning.law=thesis", "learning.gains=[0.5]"])
    (task,) = next(Plan(study, programs.names(), tmp_path).seeds())
    laid = ("--set", "learning.law=thesis", "--set", "learning.gains=[0.5]")
    assert task.machine == "20260101-harbour"
    last, config = f"{place}/shots/0001.wav", f"{place}/config.toml"
    assert task.commands == (
        ("vibractl", "replay", str(place), *laid, "--json", "replayed.json"),
        ("vibractl", "judge", last, "--config", config, *laid, "--json", "judged.json"),
    )


def test_a_run_that_has_changed_is_another_input(tmp_path: Path) -> None:
    place = run(tmp_path, "a")
    keys = []
    for content in (b"1", b"1", b"2"):
        (place / "shots" / "0000.wav").write_bytes(content)
        ((task,),) = Plan(replay_study(tmp_path, []), programs.names(), tmp_path).seeds()
        keys.append(task.key)
    assert keys[0] == keys[1] != keys[2]
    assert "--set" not in task.commands[0]


def test_a_setting_that_cannot_be_and_a_folder_without_runs_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="there is no run of a vibrator with a recorded shot"):
        replay_study(tmp_path, [])
    run(tmp_path, "a")
    with pytest.raises(ConfigError, match="did you mean law"):
        replay_study(tmp_path, ["learning.lw=thesis"])
