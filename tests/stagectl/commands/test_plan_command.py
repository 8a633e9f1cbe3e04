"""What a person types, and what comes of it."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from stagectl.__main__ import main
from tests.stagectl.planning.pockets import EXAMPLE


@pytest.fixture
def pocket(tmp_path: Path) -> str:
    file = tmp_path / "pocket.json"
    file.write_text(json.dumps(EXAMPLE))
    return str(file)


def _plan(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", "plan", *words])
    return main()


def test_a_planned_path_passes_the_check(monkeypatch: pytest.MonkeyPatch, pocket: str, tmp_path: Path) -> None:
    path, figures = str(tmp_path / "path.json"), tmp_path / "figures.json"
    assert _plan(monkeypatch, pocket, "--planner", "exact", "--out", path) == 0
    assert _plan(monkeypatch, "--check", pocket, path, "--json", str(figures)) == 0
    found = json.loads(figures.read_text())
    assert found["total"] == pytest.approx(23.796)
    assert found["gap"] == pytest.approx(0.0, abs=1e-12)
    assert (found["legal"], found["complete"], found["left"], found["error"]) == (True, True, 0, None)


def test_pockets_are_learned_one_after_the_other_and_reported(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], pocket: str, tmp_path: Path
) -> None:
    files = {
        name: tmp_path / name for name in ("path.json", "segments.csv", "path.nc", "path.mod", "plan.html", "f.json")
    }
    words = ["--out", "--record", "--gcode", "--rapid", "--report", "--json"]
    given = [word for pair in zip(words, map(str, files.values()), strict=True) for word in pair]
    assert _plan(monkeypatch, pocket, "--planner", "uncertain", "--untrained", "--pockets", "3", *given) == 0
    found = json.loads(files["f.json"].read_text())
    assert len(found["pockets"]) == 3
    assert found["pockets"][2]["total"] < found["pockets"][0]["total"]
    assert found["pockets"][2]["path"] == json.loads(files["path.json"].read_text())
    assert found["types"]["E3"]["mean"] == pytest.approx(0.075)
    assert "over the optimum" in capsys.readouterr().out
    assert "svg+xml" in files["plan.html"].read_text()
    assert _plan(monkeypatch, pocket, "--learn", str(files["segments.csv"])) == 0


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ([["E3", 0, 0, "E"]], "legal; leaves 810 of 900 cells: 2.25 s"),
        ([["E3", 0, 0, "E"], ["E3", 0, 0, "E"]], "segment 2: E3 at row 0, col 0 mills 0 rows, must be 3"),
        ([["E2d", -1, 0, "E"]], "segment 1: the tool at row -1, col 0 crosses a wall"),
    ],
)
def test_a_path_that_will_not_do_is_status_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], pocket: str, tmp_path: Path,
    path: list[Any], said: str,
) -> None:  # fmt: skip
    file = tmp_path / "path.json"
    file.write_text(json.dumps(path))
    assert _plan(monkeypatch, "--check", pocket, str(file)) == 1
    assert said in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["{pocket}", "--planner", "guess"], "planner is 'guess', must be one of"),
        (["{pocket}", "--untrained"], "planner is 'exact', must be one of sequential, uncertain"),
        (["{pocket}", "--depth", "0"], "depth is 0.0, must be > 0"),
        (["{pocket}", "--pockets", "0"], "greater than or equal to 1"),
        (["--check", "{pocket}"], "--check goes with two files"),
        (["{pocket}", "{pocket}"], "--check goes with two files"),
        (["--check", "{pocket}", "{pocket}"], "is an object, must be a list; a path is a list of"),
        (["{folder}/none.json"], "No such file"),
        (["{folder}/bad.json"], "bad.json: rows is 1, smaller than the tool"),
        (["{folder}/no.json"], "no.json: not JSON: Expecting value"),
        (["{folder}/deep.json"], "deep.json: objects or lists nested more than 12 deep"),
        (["--check", "{pocket}", "{folder}/deep.json"], "deep.json: objects or lists nested more than 12 deep"),
        (["{folder}/long.json"], "...', must be one of EW, EWNS"),
    ],
)
def test_a_mistake_is_one_line_and_status_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], pocket: str, tmp_path: Path,
    words: list[str], text: str,
) -> None:  # fmt: skip
    (tmp_path / "bad.json").write_text(json.dumps({**EXAMPLE, "rows": 1}))
    (tmp_path / "no.json").write_text("nothing")
    (tmp_path / "deep.json").write_text("[" * 200_000)
    (tmp_path / "long.json").write_text(json.dumps({**EXAMPLE, "feeds": "E" * 100_000}))
    assert _plan(monkeypatch, *(word.format(pocket=pocket, folder=tmp_path) for word in words)) == 2
    err = capsys.readouterr().err
    assert text in err
    assert err.count("\n") == 1
    assert len(err) < 300
