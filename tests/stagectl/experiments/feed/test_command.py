"""`stagectl force`, and `stagectl plan --simulate`, from the command line."""

import json
import sys
from pathlib import Path

import pytest

from stagectl.__main__ import main
from stagectl.experiments.feed.job import RATES
from tests.stagectl.experiments.feed.small_pocket import QUICK

POCKET = {"rows": 3, "cols": 13, "G": 3, "feeds": "EW", "rate": RATES, "v_lift": 50.0}
WORDS = [word for setting in QUICK for word in ("--set", setting)]


def stagectl(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", *words])
    return main()


@pytest.fixture
def pocket(tmp_path: Path) -> str:
    file = tmp_path / "pocket.json"
    file.write_text(json.dumps(POCKET))
    return str(file)


@pytest.mark.slow
def test_a_pocket_is_milled_compared_kept_replayed_and_reported(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, pocket: str
) -> None:
    run, figures = tmp_path / "run", tmp_path / "figures.json"
    words = ("force", "--task", pocket, "--force", "9", "--compare", "--out", str(run), "--json", str(figures), *WORDS)
    assert stagectl(monkeypatch, *words) == 0
    found = json.loads(figures.read_text())
    assert [each["name"] for each in found["pockets"]] == ["force-1", "position-1"]
    assert found["pockets"][0]["force_mean"] == pytest.approx(9.0, abs=0.5)
    assert "saved beside position control" in capsys.readouterr().out
    assert {"report.html", "force-1.wav", "position-1.wav", "segments.csv", "summary.json", "job.json"} <= {
        file.name for file in run.iterdir()
    }
    assert stagectl(monkeypatch, "replay", str(run)) == 0
    assert stagectl(monkeypatch, "report", str(run), "--json", str(figures)) == 0
    assert json.loads(figures.read_text()) == found


def test_a_pocket_that_is_held_is_kept_and_said_by_the_status(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, pocket: str
) -> None:
    run = tmp_path / "run"
    words = ("force", "--task", pocket, "--out", str(run), *WORDS, "--set", "force.overload=5", "--force", "9")
    assert stagectl(monkeypatch, *words) == 1
    assert "force-1 was held: the force is beyond force.overload, 5 N" in capsys.readouterr().out
    assert (run / "report.html").exists()


@pytest.mark.slow
def test_the_figure_of_the_thesis_is_made_kept_replayed_and_reported(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    run = tmp_path / "run"
    assert stagectl(monkeypatch, "force", "--task", "fig-7.5", "--out", str(run), "--png", str(tmp_path / "png")) == 0
    assert "settled to 5 % after" in capsys.readouterr().out
    assert (tmp_path / "png/control.png").exists()
    assert stagectl(monkeypatch, "replay", str(run)) == 0
    assert stagectl(monkeypatch, "report", str(run)) == 0


def test_what_a_live_run_would_do_is_said_without_a_folder_to_keep_it_in(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], pocket: str
) -> None:
    assert stagectl(monkeypatch, "force", "--task", pocket, "--live", "--dry-run", *WORDS) == 0
    assert capsys.readouterr().out.lstrip().startswith("1  ")
    assert stagectl(monkeypatch, "force", "--task", pocket, "--live", *WORDS) == 2
    assert "--live keeps what it records in --out RUN/" in capsys.readouterr().err


def test_a_planned_pocket_is_milled_with_the_force_controlled(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, pocket: str, capsys: pytest.CaptureFixture[str]
) -> None:
    figures, record = tmp_path / "figures.json", tmp_path / "segments.csv"
    words = ("plan", pocket, "--simulate", "--record", str(record), "--json", str(figures), *WORDS)
    assert stagectl(monkeypatch, *words) == 0
    first, *_, last = capsys.readouterr().err.splitlines()
    assert first.startswith("cells milled: in the simulated cell")
    assert last.startswith("cells milled 100 %")
    found = json.loads(figures.read_text())
    assert 0.5 < found["pockets"][0]["total"] < 4.0
    assert found["pockets"][0]["total"] != found["optimum"]
    assert stagectl(monkeypatch, "plan", pocket, "--learn", str(record)) == 0


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--task", "disc"], "task is 'disc', must be fig-7.5, slot, pocket, or a file POCKET.json"),
        (["--task", "none.json"], "none.json: No such file or directory"),
        (["--task", "slot", "--force", "-1"], "force.force is -1.0, must be > 0"),
        (["--task", "slot", "--planner", "best"], "planner is 'best', must be one of"),
        (["--task", "slot", "--planner", "exact", "--untrained"], "planner is 'exact', must be one of sequential"),
        (["--task", "slot", "--set", "feed_plants.cut_options.knot=0"], "knot is 0, must be 1 to 10"),
        (["--task", "slot", "--set", "plants.force_sensor_options.mood=1"], "does not take these options"),
        (["--task", "slot", "--set", "segments.home=[0, 0, 0, 0, 2.5, 0]"], "joint 5 is at"),
        (["--task", "fig-7.5", "--set", "feed_plants.process_options.kappa=0"], "kappa is 0, must be 1e-05 to 0.1"),
    ],
)
def test_a_mistake_is_one_line_and_status_2_and_leaves_no_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: list[str], text: str
) -> None:
    assert stagectl(monkeypatch, "force", "--out", str(tmp_path / "run"), *words) == 2
    told = capsys.readouterr().err
    assert text in told
    assert len(told.strip().splitlines()) == 1
    assert not (tmp_path / "run").exists()


def test_figures_without_a_folder_go_nowhere(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert stagectl(monkeypatch, "force", "--task", "fig-7.5", "--png", str(tmp_path)) == 2
    assert "--png goes with --out RUN/" in capsys.readouterr().err


def test_a_prior_is_kept_beside_a_run_and_learned_from_by_the_next_plan(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, pocket: str
) -> None:
    prior, run = tmp_path / "prior.json", tmp_path / "run"
    words = ("--planner", "uncertain", "--prior", str(prior))
    assert stagectl(monkeypatch, "force", "--task", pocket, *words, "--out", str(run), *WORDS) == 0
    assert len(json.loads(prior.read_text())["lots"]) == 1
    assert stagectl(monkeypatch, "plan", pocket, *words) == 0
    assert len(json.loads(prior.read_text())["lots"]) == 2
    before = prior.read_text()
    assert stagectl(monkeypatch, "replay", str(run)) == 0
    assert prior.read_text() == before


def test_a_prior_of_rates_that_are_not_known_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, pocket: str
) -> None:
    words = ("--planner", "uncertain", "--untrained", "--prior", str(tmp_path / "prior.json"))
    for command in (("plan", pocket), ("force", "--task", pocket)):
        assert stagectl(monkeypatch, *command, *words) != 0
        assert "prior" in capsys.readouterr().err
