"""What runs of the stage and of the cell were made with stands in their folders, and a change since is said."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.origin import RUN, checksum, read_origin
from rigkit.run_folder import CONFIG
from stagectl.__main__ import main
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import write_milling
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.robot.milling.test_milling_models import models

SHORT = {
    "cell runs": "cell --setup A --set toroid.lead=1.0 --set toroid.turn=0.005 --set toroid.ramp=0.1",
    "force run": "force --task slot --set segments.travel=0.1 --set segments.plunge=0.1 --set segments.stationary=0.2"
    " --set segments.slowest=0.1 --set feed_plants.cut_options.knots=0",
    "mid-ranging run": "midrange --scenario thesis-2",
}


def stagectl(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", *words])
    return main()


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", SHORT)
def test_a_run_keeps_what_it_was_made_with(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = tmp_path / "run"
    assert stagectl(monkeypatch, *SHORT[kind].split(), "--out", str(run)) == 0
    origin = read_origin(run / RUN)
    assert origin is not None
    assert origin.kind == kind
    assert origin.settings == rig_file.load(run / CONFIG, CellConfig, as_written=True).model_dump(mode="json")
    assert dict(origin.parts) == {name: checksum(run / name) for name in origin.parts}
    capsys.readouterr()
    assert stagectl(monkeypatch, "report", str(run)) == 0
    capsys.readouterr()
    assert stagectl(monkeypatch, "export", str(run), "--to", "parquet") == 0
    assert capsys.readouterr().err == ""
    assert stagectl(monkeypatch, "export", str(run), "--to", "parquet") == 0
    assert capsys.readouterr().err.startswith(f"written over: {run}/export/")


def test_a_replay_says_what_was_edited_since(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = tmp_path / "run"
    assert stagectl(monkeypatch, *SHORT["cell runs"].split(), "--out", str(run)) == 0
    before = rig_file.load(run / CONFIG, CellConfig, as_written=True)
    (run / CONFIG).write_text(rig_file.dump(rig_file.load(run / CONFIG, CellConfig, ("robot.tool=0.2",))))
    capsys.readouterr()
    stagectl(monkeypatch, "replay", str(run))
    said = f"{run}/ has changed since the run was made: robot.tool was {before.robot.tool}, is 0.2"
    assert said in capsys.readouterr().err


def test_models_of_a_cell_that_was_wired_otherwise_are_refused_until_the_key_is_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    measured = rig_file.load(None, CellConfig, ("robot.tool=0.25",))
    known = replace(models(), provenance={"config": rig_file.dump(measured)})
    write_milling(tmp_path / "milling.h5", known, {})
    (tmp_path / "logs").mkdir()
    words = ("ilc", "--model", str(tmp_path / "milling.h5"), "--from", str(tmp_path / "logs"))
    assert stagectl(monkeypatch, *words) == 2
    told = capsys.readouterr().err
    assert "was measured on a cell that was wired otherwise: robot.tool was 0.25, is 0.1" in told
    assert "--accept robot.tool" in told
    stagectl(monkeypatch, *words, "--accept", "robot.tool")
    told = capsys.readouterr().err
    assert "robot.tool was 0.25, is 0.1" in told
    assert "--accept" not in told


def test_too_few_models_of_a_stage_are_refused_in_one_line_and_nothing_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file, *_ = write_models(tmp_path)
    words = [*SHORT["cell runs"].split(), "--model", str(file), "--out", str(tmp_path / "run")]
    assert stagectl(monkeypatch, *words) == 2
    assert capsys.readouterr().err.startswith("error: there are 1 model files, must be one for each of the axes")
    assert not (tmp_path / "run").exists()
