"""What every command line shares: how it ends, and what it writes where."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from rigkit import command
from tests.rigkit import command_line
from tests.rigkit.command_line import app
from tests.until import EVER


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch):
    def run(*arguments: str) -> int:
        monkeypatch.setattr(sys, "argv", ["rig", *arguments])
        return command.run(app, "tests")

    return run


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["end", "value"], "error: audio.rate is 3, must be 4"),
        (["end", "key"], "error: no block 'guard'"),
        (["end", "file"], "error: /nowhere/rig.toml: No such file or directory"),
        (["end", "within a file"], f"error: {command_line.__file__}: is a file, must be a folder"),
        (["end", "full"], "error: No space left on device"),
        (["end", "device"], "error: no device 'card'; there are shaker"),
        (["show", "--set", "device.rate=3"], "error: --set device.rate=3: device.rate is 3, must be >= 8000 and "
         "<= 192000 samples/s"),
        (["show", "--config", "/nowhere/rig.toml"], "error: /nowhere/rig.toml: No such file or directory"),
        (["show", "--json", "/nowhere/x"], "error: --json /nowhere/x cannot be: /nowhere is no folder"),
        (["show", "--nope"], "error: No such option: --nope; --help shows how to call this"),
        (["frob"], "error: No such command 'frob'; --help shows how to call this"),
        ([], "error: Missing command; --help shows how to call this"),
    ],
)  # fmt: skip
def test_what_a_person_can_put_right_is_one_line_and_status_2(
    arguments: list[str], message: str, call, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(*arguments) == 2
    captured = capsys.readouterr()
    assert captured.err == f"{message}\n"
    assert captured.out == ""


@pytest.mark.parametrize(("kind", "fault"), [("numpy", ValueError), ("slip", KeyError), ("program", RuntimeError)])
def test_a_fault_of_the_program_keeps_its_traceback(kind: str, fault: type[Exception], call) -> None:
    with pytest.raises(fault):
        call("end", kind)


def test_a_value_error_that_another_package_raises_is_no_word_to_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["rig", "end", "value"])
    with pytest.raises(ValueError, match="audio.rate"):
        command.run(app)


def test_a_stopped_command_says_how_to_go_on(call, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("end", "stopped") == 130
    assert capsys.readouterr().err == "stopped after shot 3; run --resume RUN/ goes on\n"


def test_a_command_that_did_its_work_ends_with_0(call, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("show", "--set", "device.gain=3") == 0
    assert "Device [1]" in capsys.readouterr().out


def test_figures_go_to_a_file_and_the_table_to_stdout(call, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("show", "--json", str(tmp_path / "figures.json")) == 0
    assert json.loads((tmp_path / "figures.json").read_text()) == {"rate": 44100, "gain": 1.5, "worst": None}
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["key", "value", "[V]"] in rows
    assert ["gain", "[bold]", "1.5"] in rows


def test_figures_on_stdout_have_it_for_themselves(call, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("show", "--json", "-") == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out)["rate"] == 44100
    assert "gain" in captured.err


def test_help_shows_the_options_and_the_example(call, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("show", "--help") == 0
    text = capsys.readouterr().out
    for words in ("--config", "--set", "TABLE.KEY=VALUE", "--json", "show --set device.rate=48000", "[of the device]"):
        assert words in text


def test_a_lone_command_keeps_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    lone = command.application("Has one command.")
    lone.command("vibrator")(lambda: None)
    monkeypatch.setattr(sys, "argv", ["calibrate", "vibrator"])
    assert command.run(lone) == 0


def test_ctrl_c_ends_with_130_and_without_a_traceback() -> None:
    line = [sys.executable, "-m", "tests.rigkit.command_line", "wait"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=EVER)
    assert process.returncode == 130
    assert errors == "\nstopping safely; Ctrl-C again ends at once\nstopped\n"


def test_a_module_run_with_m_counts_as_its_package() -> None:
    line = [sys.executable, "-m", "tests.rigkit.command_line", "end", "value"]
    done = subprocess.run(line, capture_output=True, text=True, timeout=EVER, check=False)
    assert (done.returncode, done.stderr) == (2, "error: audio.rate is 3, must be 4\n")


def test_options_are_laid_over_what_was_set_and_those_not_given_stand_for_nothing() -> None:
    flags = {"a.seed": 0, "a.live": True, "a.quiet": False, "a.side": None, "a.text": "chirp:40:90:5"}
    assert command.laid_over(["a.seed=3"], flags) == ["a.seed=3", "a.seed=0", "a.live=true", "a.text=chirp:40:90:5"]
    assert command.laid_over(None, {}) == []
