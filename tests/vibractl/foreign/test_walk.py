"""The walk of docs/own-recordings.md: a laboratory that has nothing of this project, and what becomes of its files."""

import ast
import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

from rigkit.run_folder import read_events, read_quality
from tests.contract.source_tree import ROOT
from tests.vibractl.foreign.lab_of_files import LabOfFiles
from tests.vibractl.linear_rig import RATE

SCRIPT = ROOT / "examples" / "own_recordings.py"
FILES = ["noise-drive.wav", "noise-response.wav", "session.wav", "shot.csv", "shot.mat", "silence.wav"]
REFERENCE = ("--config", "rig.toml", "--reference", "chirp:40:90:1")
CHANNELS = "drive_1=1,drive_2=2,response_1=3,response_2=4"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    """Return the laboratory's script."""
    described = importlib.util.spec_from_file_location("own_recordings", SCRIPT)
    assert described is not None
    assert described.loader is not None
    module = importlib.util.module_from_spec(described)
    described.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def written(script: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the laboratory's folder, with sweeps of a second."""
    folder: Path = tmp_path_factory.mktemp("laboratory") / "lab"
    script.main(folder, 1.0)
    return folder


@pytest.fixture
def lab(
    written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> LabOfFiles:
    """Return a folder in which commands are given, beside the laboratory's files."""
    made = LabOfFiles(tmp_path, monkeypatch, capsys)
    (tmp_path / "lab").symlink_to(written)
    return made


def test_the_laboratory_has_nothing_of_this_project(written: Path) -> None:
    tree = ast.parse(SCRIPT.read_text())
    plain = [each.names[0].name for each in ast.walk(tree) if isinstance(each, ast.Import)]
    found = [*plain, *(str(each.module) for each in ast.walk(tree) if isinstance(each, ast.ImportFrom))]
    assert {name.split(".")[0] for name in found} <= {"numpy", "scipy", *sys.stdlib_module_names}
    assert sorted(file.name for file in written.iterdir()) == FILES


@pytest.mark.parametrize("file", ["lab/shot.csv", "lab/shot.mat"])
def test_a_shot_of_labview_and_one_of_matlab_are_found(lab: LabOfFiles, file: str) -> None:
    lab.done("vibractl", "import", *REFERENCE, "--drive", file, "--response", file, "--dry-run", "--json", "found.json")
    (found,) = json.loads(Path("found.json").read_text())["found"]
    assert found["begins_s"] == pytest.approx(0.2, abs=1e-6)
    assert found["correlation"] > 0.5


def test_a_session_is_imported_with_its_silence_and_reported(lab: LabOfFiles) -> None:
    files = ("--drive", "lab/session.wav", "--response", "lab/session.wav", "--map", CHANNELS)
    lab.done("vibractl", "import", *REFERENCE, *files, "--silence", "lab/silence.wav", "--out", "SESSION")
    shots = [each for each in read_events("SESSION") if each["event"] == "shot"]
    length, pause = round(1.6 * RATE), round(0.7 * RATE)
    begins = [pause + shot * (length + pause) + round(0.2 * RATE) for shot in range(3)]
    assert [RATE * each["begins_s"] for each in shots] == pytest.approx(begins, abs=1.0)
    (silence,) = [each for each in read_events("SESSION") if each["event"] == "silence"]
    assert max(silence["over_the_limit_db"]) < -20.0
    assert "worst bin, dB over" in lab.done("vibractl", "judge", "lab/shot.mat", *REFERENCE)


@pytest.mark.slow
def test_a_model_of_its_noise_gives_drives_that_it_plays_and_that_are_learned_from(
    lab: LabOfFiles, script: ModuleType
) -> None:
    noise = ("lab/noise-drive.wav", "lab/noise-response.wav")
    lab.done("calibrate", "vibrator", "--config", "rig.toml", "--from", *noise, "--out", "lab.h5")
    words = ("--state", "LAB.h5", "--out")
    lab.done("vibractl", "step", *REFERENCE, "--model", "lab.h5", *words, "next.wav")
    script.play(Path("next.wav"), Path("heard.wav"))
    files = ("--drive", "next.wav", "--response", "heard.wav")
    lab.done("vibractl", "step", *files, *words, "after.wav")
    lab.done("vibractl", "import", *REFERENCE, *files, "--model", "lab.h5", "--out", "PLAYED")
    (row,) = read_quality("PLAYED")
    assert max(float(row[f"error_db_{side}"]) for side in (1, 2)) < -20.0
    lab.done("vibractl", "replay", "PLAYED", "--json", "replayed.json")
    assert max(json.loads(Path("replayed.json").read_text())["difference_db"]) < -100.0
