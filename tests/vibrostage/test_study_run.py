"""`vibrostage study run` as a person calls it: to the end through kills of workers, of the program, and a cluster."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from rigkit.study.outcome import KILLED, TOO_LONG
from rigkit.study.results import Row, read_rows
from stagectl.planning.example_pocket import EXAMPLE_POCKET
from tests.rigkit.study.small_study import STUDY
from tests.until import EVER, until
from tests.vibrostage.killing import killed_after, workers
from tests.vibrostage.trial import programs_with_trial
from vibrostage.__main__ import main

TRIAL = """
name = "trials"
commands = ["trial {seed} {kind} first.json", "trial {seed} {kind} told.json {first.json:shots[0].iae}"]
seeds.count = 40
settings.values.kind = ["slow", "refused"]
[figures]
gap = {file = "told.json", path = "gap"}
iae = {file = "told.json", path = "shots[*].iae", reduce = "max"}
met = {file = "told.json", path = "met", kind = "event", until = 9}
"""
Call = Callable[..., tuple[int, dict[str, Any], str]]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder with a study of 80 tasks."""
    (tmp_path / "study.toml").write_text(TRIAL)
    (tmp_path / "programs").mkdir()
    programs_with_trial(tmp_path / "programs", monkeypatch)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Return a function that runs the program in this process and gives status, figures and errors."""

    def called(*words: str) -> tuple[int, dict[str, Any], str]:
        monkeypatch.setattr(sys, "argv", ["vibrostage", "study", *words, "--json", "-"])
        status = main()
        printed = capsys.readouterr()
        return status, json.loads(printed.out) if printed.out else {}, printed.err

    return called


def results(out: str) -> list[Row]:
    return read_rows(Path(out) / "results")[1]


@pytest.mark.slow
def test_the_result_is_the_same_with_one_worker_with_three_and_with_workers_that_are_killed(call: Call) -> None:
    _, alone, _ = call("run", "study.toml", "--out", "one", "--workers", "1")
    with killed_after(4, Path("three/tasks"), os.getpid()) as killed:
        status, other, _ = call("run", "study.toml", "--out", "three", "--workers", "3")
    assert status == 0
    assert alone == other
    assert (alone["tasks"], alone["refused"], alone["failed"]) == (80, 13, 0)
    assert workers(os.getpid()) == []
    assert len(killed) > 5
    assert 0 < sum(row.tries - 1 for row in results("three")) <= len(killed)
    assert [row.figures for row in results("one")] == [row.figures for row in results("three")]
    assert list(Path("three").glob("tasks/*")) == []
    assert all("told.json 0." in row.commands[1] for row in results("one") if not row.status)


def test_what_came_of_each_task_is_a_result(call: Call) -> None:
    kinds = 'settings.values.kind=["refused","fault","exit","crash","killed","silent"]'
    ran = ("run", "study.toml", "--out", "o", "--set", kinds, "--set", "seeds={first=3,count=1}")
    status, told, said = call(*ran, "--workers", "2")
    assert (status, told["tasks"], told["refused"], told["failed"]) == (0, 6, 1, 5)
    assert "1 refused, 5 failed" in said
    came = {row.case["kind"]: (row.status, row.failed, row.message, row.tries) for row in results("o")}
    assert came["refused"] == (2, 1, "error: seed 3 in x, must be odd", 1)
    assert came["fault"] == (1, 1, "RuntimeError: seed 3", 1)
    assert came["exit"] == (1, 1, "", 1)
    assert came["silent"] == (1, 2, "", 1)
    assert came["crash"] == (KILLED, 1, "its process was ended 3 times, the last by status -11", 3)
    assert came["killed"] == (KILLED, 1, "its process was ended 10 times, the last by status -9", 10)
    assert all(row.figures == {"gap": None, "iae": None, "met": None} for row in results("o"))


def test_a_task_whose_command_was_stopped_is_begun_again(call: Call) -> None:
    once = ("--set", 'settings.values.kind=["stopped"]', "--set", "seeds.count=2")
    assert call("run", "study.toml", "--out", "o", *once, "--workers", "1")[1]["failed"] == 0
    assert [(row.status, row.failed, row.tries) for row in results("o")] == [(0, 0, 2)] * 2
    assert all(row.figures["gap"] is not None for row in results("o"))


def test_a_task_that_takes_too_long_is_killed(call: Call) -> None:
    hangs = ("--set", 'settings.values.kind=["hang"]', "--set", "seeds.count=2", "--set", "budget.task_seconds=0.5")
    _, told, _ = call("run", "study.toml", "--out", "o", *hangs, "--workers", "1")
    assert told["failed"] == 2
    assert {(row.status, row.message) for row in results("o")} == {(TOO_LONG, "killed after 0.5 s")}


@pytest.mark.slow
def test_a_killed_program_takes_its_workers_along_and_goes_on_by_the_same_command(folder: Path, call: Call) -> None:
    command = [sys.executable, "-m", "vibrostage", "study", "run", "study.toml", "--out", "killed"]
    with subprocess.Popen([*command, "--set", "seeds.count=9000"], stderr=subprocess.DEVNULL) as program:
        until(lambda: len(list(folder.glob("killed/tasks/4-*"))) > 0)
        started = workers(program.pid)
        program.send_signal(signal.SIGKILL)
    assert started
    until(lambda: not any(_is_alive(pid) for pid in started))
    status, whole, said = call("run", "study.toml", "--out", "killed", "--workers", "2")
    assert status == 0
    assert "seeds.count was 9000, is 40" in said
    assert whole == call("run", "study.toml", "--out", "fresh", "--workers", "2")[1]


@pytest.mark.slow
def test_ctrl_c_stores_what_is_done_and_says_how_to_go_on(folder: Path) -> None:
    command = [sys.executable, "-m", "vibrostage", "study", "run", "study.toml", "--out", "stopped"]
    with subprocess.Popen([*command, "--set", "seeds.count=9000"], stderr=subprocess.PIPE, text=True) as program:
        until(lambda: len(list(folder.glob("stopped/tasks/2-*"))) > 0)
        program.send_signal(signal.SIGINT)
        said = program.communicate(timeout=EVER)[1]
    assert program.returncode == 130
    assert "of 18000 tasks" in said
    assert "the same command continues" in said
    assert results("stopped")


@pytest.mark.slow
def test_the_command_that_is_stored_gives_the_same_figure_in_an_empty_folder(folder: Path, call: Call) -> None:
    (folder / "pocket.json").write_text(EXAMPLE_POCKET)
    (folder / "pockets.toml").write_text(STUDY % 1)
    (folder / "programs" / f"{next((folder / 'programs').iterdir()).name}/entry_points.txt").write_text(
        "[console_scripts]\nstagectl = stagectl.__main__:main\n"
    )
    call("run", "pockets.toml", "--out", "o", "--set", "keep=all", "--workers", "1")
    (row,) = results("o")
    (place,) = folder.glob("o/tasks/1-default-*")
    assert {"p.json", "plan.json", "pocket.json", "stdout.txt", "stderr.txt"} <= {each.name for each in place.iterdir()}
    empty = folder / "empty"
    empty.mkdir()
    (empty / "pocket.json").write_text(EXAMPLE_POCKET)
    line = f"{Path(sys.executable).parent}/{row.commands[0]}"
    done = subprocess.run(line, shell=True, cwd=empty, capture_output=True, timeout=EVER, check=False)
    assert done.returncode == 0
    assert json.loads((empty / "plan.json").read_text())["pockets"][-1]["gap"] == row.figures["gap"]


@pytest.mark.slow
def test_a_cluster_gives_the_same_and_processes_of_its_workers_may_die(folder: Path, call: Call) -> None:
    distributed = pytest.importorskip("distributed", reason="distributed is not installed")
    options = {"threads_per_worker": 1, "processes": False, "dashboard_address": None, "protocol": "tcp"}
    with distributed.LocalCluster(2, local_directory=str(folder / "dask"), **options) as cluster:
        with killed_after(9, folder / "dask", os.getpid()) as killed:
            status, told, _ = call("run", "study.toml", "--out", "o", "--scheduler", cluster.scheduler_address)
        until(lambda: workers(os.getpid()) == [])
    assert status == 0
    assert killed
    assert told == call("run", "study.toml", "--out", "here", "--workers", "1")[1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--scheduler", "lab-7"], "--scheduler is 'lab-7', must be such as tcp://lab-7:8786"),
        (["--scheduler", "tcp://localhost:1", "--workers", "2"], "must be one of them"),
        (["--set", "seeds.count=0"], "--set seeds.count=0: seeds.count is 0, must be >= 1 and <= 1000000 seeds"),
    ],
)
def test_what_cannot_be_run_is_refused_in_one_line(folder: Path, call: Call, words: list[str], said: str) -> None:
    status, _, told = call("run", "study.toml", "--out", "o", *words)
    assert (status, told.count("\n")) == (2, 1)
    assert said in told
    assert not list(folder.glob("o/results/*"))


def _is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
