"""What runs of the stage and of the cell were made with stands in their folders, and a change since is said."""

import sys
from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.origin import RUN, checksum, read_origin
from rigkit.run_folder import CONFIG
from stagectl.__main__ import main
from stagectl.robot.config import CellConfig

SHORT = {
    "cell runs": "cell --setup A --set toroid.lead=1.0 --set toroid.turn=0.005 --set toroid.ramp=0.1",
    "force run": "force --task slot --set segments.travel=0.2 --set segments.plunge=0.1 --set segments.stationary=0.2"
    " --set segments.slowest=0.1 --set feed_plants.cut_options.knots=0",
    "mid-ranging run": "midrange --scenario thesis-2",
}


def stagectl(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", *words])
    return main()


@pytest.mark.parametrize("kind", SHORT)
def test_a_run_keeps_what_it_was_made_with(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = tmp_path / "run"
    assert stagectl(monkeypatch, *SHORT[kind].split(), "--out", str(run)) == 0
    origin = read_origin(run / RUN)
    assert origin is not None
    assert origin.kind == kind
    assert origin.settings == rig_file.load(run / CONFIG, CellConfig, as_written=True).model_dump(mode="json")
    assert dict(origin.parts) == {name: checksum(run / name) for name in origin.parts}


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
