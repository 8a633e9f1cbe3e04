"""`calibrate milling` and `stagectl ilc` as whole commands, on a small pocket and a short sweep."""

import json
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.__main__ import main as calibrate
from calibration.milling.session import dry_run, motion_seconds, output_of
from calibration.milling.sweep_session import sweep_path
from calibration.output import Wish
from ctlblocks.recording import Recording, write
from stagectl.__main__ import main as stagectl
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import read_milling

pytestmark = pytest.mark.slow

SETTINGS = (
    "pocket.size=[20e-3, 20e-3]",
    "pocket.depth=1e-3",
    "pocket.clearance=3e-4",
    "pocket.lead=1.0",
    "pocket.tail=0.5",
    "pocket.workpiece=[30e-3, 30e-3, 5e-3]",
    "friction.poses=12",
    "friction.seconds=2",
    "friction.lowest=[-12, -8, -14, -16, -16, -16]",
    "friction.highest=[12, 8, 14, 16, 16, 16]",
    "chirp.seconds=4",
    "learning.free=1",
)
WORDS = ("--task", "pocket", *(word for setting in SETTINGS for word in ("--set", setting)))


def shell(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", list(words))
    return {"calibrate": calibrate, "stagectl": stagectl}[words[0]]()


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Calibrated by the command."""
    folder = tmp_path_factory.mktemp("calibrated")
    found = folder / "found.json"
    with pytest.MonkeyPatch.context() as patch:
        words = ("calibrate", "milling", "--out", str(folder / "milling.h5"), "--json", str(found), *WORDS)
        assert shell(patch, *words) == 0
    return folder / "milling.h5"


def test_all_motions_take_as_long_as_their_parts() -> None:
    cell = CellConfig()
    parts = [float(each) for line in dry_run(cell, "pocket28") for each in re.findall(r": ([\d.]+) s", line)]
    chirps, in_the_air, in_material = parts
    trials = (cell.learning.free + 1) * in_the_air + in_material
    assert motion_seconds(cell, "pocket28") == pytest.approx(len(sweep_path(cell)) / 250.0 + chirps + trials, abs=1.0)


def test_models_fit_what_was_held_back(model: Path) -> None:
    found = json.loads((model.parent / "found.json").read_text())
    assert min(found["robot"]["motors"]["fresh"]) > 85.0
    assert min(found["process"]["measured"]["compliance"]) > 50.0
    assert min(found["process"]["estimated"]["compliance"]) > 50.0
    assert "Deflection, measured force" in model.with_suffix(".html").read_text()


def test_a_pocket_is_learned_replayed_reported_and_learned_from_its_logs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, model: Path
) -> None:
    run = tmp_path / "run"
    ilc = ("stagectl", "ilc", "--model", str(model), *WORDS, "--method", "3")
    assert shell(monkeypatch, *ilc, "--iterations", "1", "--out", str(run)) == 0
    said = capsys.readouterr().out
    assert re.match(r"\d+ trials of \d+ s each, simulated some five times as fast\n", said)
    assert "as Table 5.1" in " ".join(said.split())
    first, last = json.loads((run / "summary.json").read_text())["methods"]["3"]
    assert last["true_norm"] < 0.5 * first["true_norm"]
    assert shell(monkeypatch, "stagectl", "replay", str(run)) == 0
    assert "made again: milled-0-trial\n" in capsys.readouterr().err
    assert shell(monkeypatch, "stagectl", "report", str(run)) == 0

    logs = run / "logs/milled-0"
    capsys.readouterr()
    assert shell(monkeypatch, *ilc, "--method", "1", "--from", str(logs)) == 0
    assert "no touch-off" in capsys.readouterr().out
    shutil.copytree(run / "logs/free-1", logs / "free")
    assert shell(monkeypatch, *ilc, "--from", str(logs)) == 0
    assert "no touch-off" not in capsys.readouterr().out
    files = (logs / "next.csv", run / "logs/method-3-1/sent.csv")
    by_logs, by_run = (np.loadtxt(file, delimiter=",", skiprows=1, usecols=(1, 2, 3)) for file in files)
    assert np.abs(by_logs - by_run).mean() < 40e-6
    head, *rows = (logs / "force.csv").read_text().splitlines()
    turned = (",".join([row.split(",")[0], *(repr(-float(cell)) for cell in row.split(",")[1:])]) for row in rows)
    (logs / "force.csv").write_text("\n".join([head, *turned]))
    assert shell(monkeypatch, *(*ilc[:-2], "--method", "2"), "--from", str(logs)) == 2
    assert "the force's sign appears reversed (correlation -0.9" in capsys.readouterr().err


def test_a_calibration_killed_in_its_last_trial_goes_on_to_the_same_models(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, model: Path
) -> None:
    shutil.copytree(model.parent / "milling.raw", tmp_path / "milling.raw")
    for file in (tmp_path / "milling.raw").glob("milled-0-*"):
        file.unlink()
    again = tmp_path / "milling.h5"
    assert shell(monkeypatch, "calibrate", "milling", "--out", str(again), *WORDS) == 0
    frequency = np.linspace(0.0, 10.0, 20)
    found, before = (read_milling(file).process["measured"].model.coupling(frequency) for file in (again, model))
    assert np.array_equal(found, before)


@pytest.mark.parametrize(
    ("setting", "text"),
    [
        ("pocket.size=[12e-3, 12e-3]", "the path is in the material for 4.47 s, must be >= 8 s"),
        ("pocket.depth=9", "pocket.depth"),
        ("friction.speed=0.06", "a sweep by [friction] gives the friction of joint 3 at up to"),
        ("friction.poses=2", "friction.poses"),
        ("friction.highest=[200, 8, 14, 16, 16, 16]", "joint 1"),
    ],
)
def test_what_cannot_be_calibrated_is_refused_before_anything_moves(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, setting: str, text: str
) -> None:
    words = ("calibrate", "milling", "--out", str(tmp_path / "milling.h5"), *WORDS, "--set", setting)
    assert shell(monkeypatch, *words) != 0
    assert text in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--yes",), "--yes goes with --live"),
        (("--live",), "no terminal"),
        (("--live", "--yes", "--set", "robot.signals=0"), "robot.signals is 0"),
        (("--live", "--yes", "--set", "robot.commands=0"), "robot.commands is 0"),
    ],
)
def test_a_live_calibration_wants_wires_and_somebody_beside_the_robot(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    words: tuple[str, ...],
    text: str,
) -> None:
    given = ("calibrate", "milling", "--out", str(tmp_path / "milling.h5"), *WORDS, *words)
    assert shell(monkeypatch, *given) != 0
    assert text in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [("--live",), ("--dry-run",), ("--out", "RUN/"), ("--png", "FIGURES/")])
def test_learning_from_logs_runs_nothing_and_makes_no_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: tuple[str, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert shell(monkeypatch, "stagectl", "ilc", "--from", str(tmp_path), *words) == 2
    assert f"{words[0]} and --from are given, must be one of them" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_recordings_of_the_simulated_cell_are_not_gone_on_with_on_the_robot(tmp_path: Path) -> None:
    out, cell = tmp_path / "milling.h5", CellConfig()
    writes = output_of(out, cell, Wish(), is_live=True)
    with writes.begun():
        write(writes.raw / "sweep.wav", Recording(("u",), ("V",), 100.0, np.zeros((3, 1), np.float32)))
    output_of(out, cell, Wish(), is_live=True)
    with pytest.raises(ValueError, match="is of a calibration of milling, live, this is a calibration of milling, sim"):
        output_of(out, cell, Wish())
