"""What a person at the shell meets: one line and status 2, and nothing is written."""

from pathlib import Path

import pytest

from tests.rigkit.test_disk_space import leave
from tests.vibractl.linear_rig import linear_model
from vibractl.__main__ import main


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("simulator.plant=no.such:Plant", "simulator.plant, no.such:Plant: there is no module no"),
        ("simulator.plant=math:floor", "math:floor is a builtin_function_or_method, must be the class of a Block"),
        ("simulator.options.sed=1", "unexpected keyword argument 'sed'; there are seed, nonlinearity"),
        ("audio.stream=no_such:Stream", "audio.stream, no_such:Stream: there is no module no_such"),
        ("limits.peak=0.1", "limits.peak is 0.1 V"),
        ("limits.peek=1", "limits.peek is 1, but [limits] has no peek; did you mean peak?"),
        ("reference.amplitude=-1", "reference.amplitude is -1, must be > 0"),
    ],
)
def test_a_run_that_cannot_start_is_one_line_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], setting: str, words: str
) -> None:
    model, out = linear_model(tmp_path), tmp_path / "run"
    command = ["vibractl", "run", "--model", str(model), "--out", str(out), "--set", setting, "--shots", "1"]
    monkeypatch.setattr("sys.argv", [*command, "--set", "audio.isolated=false"])
    assert main() == 2
    errors = [line for line in capsys.readouterr().err.splitlines() if "learning" not in line]
    assert len(errors) == 1
    assert words in errors[0]
    assert not out.exists()


def test_a_run_for_which_there_is_no_room_is_one_line_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    leave(200e6, monkeypatch)
    command = ["vibractl", "run", "--model", str(linear_model(tmp_path)), "--out", str(tmp_path / "run")]
    monkeypatch.setattr("sys.argv", [*command, "--shots", "100", "--set", "audio.isolated=false"])
    assert main() == 2
    errors = [line for line in capsys.readouterr().err.splitlines() if "learning" not in line]
    assert len(errors) == 1
    assert "run: 100 shots of 4.941 MB may take 543.5 MB, 200 MB are free and 67.11 MB of it stay so" in errors[0]
    assert not (tmp_path / "run").exists()
