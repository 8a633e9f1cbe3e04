"""The command line: what a person types, and what comes of mistakes."""

import io
import json
import sys
from pathlib import Path

import pytest

from stagectl.__main__ import main
from stagectl.experiments.toroid.experiment import Toroid
from tests.rigkit.test_disk_space import leave
from tests.stagectl.experiments.toroid.short_cell import SHORT, short

QUICK = [word for setting in SHORT for word in ("--set", setting)]


def stagectl(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", *words])
    return main()


def test_a_run_ends_with_a_table_figures_and_a_report_and_can_be_replayed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    figures, run = tmp_path / "figures.json", str(tmp_path / "run")
    assert stagectl(monkeypatch, "cell", "--setup", "B", "--out", run, *QUICK, "--json", str(figures)) == 0
    made = json.loads(figures.read_text())
    assert made["setup"] == "B"
    assert made["fault"] is None
    assert made["circle_mae"] < 2e-4
    assert "MAE, circle" in capsys.readouterr().out
    assert stagectl(monkeypatch, "replay", run) == 0
    assert stagectl(monkeypatch, "report", run, "--json", str(figures)) == 0
    assert json.loads(figures.read_text()) == {"setups": [made]}


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--setup", "D"], "setup is 'D', must be one of A, B, C, C-fixed"),
        (["--setup", "A", "--set", "toroid.feed=1"], "toroid.feed is 1, must be >= 0.001 and <= 0.05 m/s"),
        (
            ["--setup", "A", "--set", "plants.robot_options.gear_error=-1"],
            "plants.robot_options.gear_error is -1, must be 0 to 10",
        ),
        (["--setup", "A", "--set", "simulator.options.seed=-1"], "simulator.options.seed is -1, must be"),
        (["--setup", "A", "--set", "toroid.arm=puma"], "the arm is 'puma', must be irb140, kuka, or an arm's file"),
        (["--setup", "A", "--set", "plants.cut_options.speed=1"], "does not take these options"),
        (["--setup", "A", "--set", "toroid.home=[0, 0, 0, 0, 2.18, 0]"], "joint 5 is at"),
        (["--setup", "C", "--model", "x.h5"], "there are 1 model files, must be one for each of the axes x, y, z"),
    ],
)
def test_a_mistake_is_one_line_and_status_2_and_leaves_no_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: list[str], text: str
) -> None:
    assert stagectl(monkeypatch, "cell", "--out", str(tmp_path / "run"), *words) == 2
    assert text in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_a_run_for_which_there_is_no_room_is_one_line_and_leaves_no_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    leave(67e6, monkeypatch)
    assert stagectl(monkeypatch, "cell", "--setup", "A", "--out", str(tmp_path / "run"), *QUICK) == 2
    assert "run: the recordings may take" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_the_room_that_is_asked_for_is_enough(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    run = tmp_path / "run"
    assert stagectl(monkeypatch, "cell", "--setup", "A", "--out", str(run), *QUICK) == 0
    taken = sum(file.stat().st_size for file in run.glob("A-*"))
    room = Toroid([short("A")]).room
    assert 0.5 * room < taken < room


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--setup", "A"], "--out is missing: the run's folder"),
        (["--out", "run"], "--setup is missing: A, "),
        (["--resume", "run", "--setup", "A"], "--setup and --resume are given, must be one of them"),
        (["--resume", "run", "--set", "toroid.feed=0.01"], "--set and --resume are given, must be one of them"),
        (["--resume", "run"], "run/ is not the folder of a run: it has no config.toml"),
        (["--setup", "A", "--out", "run", "--yes"], "--yes goes with --live, which is not given"),
        (["--setup", "A", "--out", "run", "--live", "--paced"], "--paced and --live are given, must be one of them"),
        (["--setup", "A", "--out", "run", "--live"], "toroid.arm is 'kuka' and robot.arm 'irb140', must be the same"),
        (
            ["--setup", "A", "--out", "run", "--live", "--set", "robot.arm=kuka"],
            "the standard input is no terminal: nobody can confirm",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: list[str], text: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("stagectl.robot.live.person.sys.stdin", io.StringIO())
    assert stagectl(monkeypatch, "cell", *words) == 2
    assert text in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
