"""Every command writes its figures with --json, and takes --set where it loads settings, so that studies can run it."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rigkit.command import USER_ERROR
from tests.commands.dry_parse import options
from tests.commands.running import MAINS
from tests.until import EVER

WITHOUT_CONFIG = {
    "vibractl replay": "the run's own file",
    "stagectl replay": "the run's own file",
    "firmware-sim draw": "the file that it draws",
    "vibrostage study run": "the study's file",
    "vibrostage study replay": "the file of each run",
}
"""Commands that take --set and no --config, and what is laid over."""
PRINT = ("vibractl example-config", "stagectl example-config", "stagectl example-cell", "vibrostage study example")


def test_every_command_writes_its_figures_as_json() -> None:
    assert {name for name, names in options().items() if "--json" not in names} == set()


def test_every_command_that_loads_settings_lets_them_be_set() -> None:
    both = {name: ("--config" in names, "--set" in names) for name, names in options().items()}
    assert {name for name, (loads, sets) in both.items() if loads and not sets} == set()
    assert {name for name, (loads, sets) in both.items() if sets and not loads} == set(WITHOUT_CONFIG)


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], int]:
    def called(line: str) -> int:
        words = line.split()
        monkeypatch.setattr(sys, "argv", words)
        return MAINS[words[0]]()

    return called


@pytest.mark.parametrize("name", PRINT)
def test_an_example_is_an_object_whose_text_goes_to_people(
    name: str, call: Callable[[str], int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(name) == 0
    text = capsys.readouterr().out
    assert call(f"{name} --json -") == 0
    printed = capsys.readouterr()
    assert printed.err == text
    assert isinstance(json.loads(printed.out), dict)


def test_a_command_that_serves_writes_them_once_it_is_ready(tmp_path: Path) -> None:
    """The relay stands for all: `firmware_sim.ready`."""
    words = [sys.executable, "-m", "firmware_sim", "relay", "--pty", "--folder", str(tmp_path), "--json", "-"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as served:
        assert served.stdout is not None
        first = [served.stdout.readline() for _ in range(3)]
        served.send_signal(signal.SIGTERM)
        rest, said = served.communicate(timeout=EVER)
    assert json.loads("".join(first) + rest) == {"can": str(tmp_path / "can")}
    assert said.startswith(f"CAN adapter: {tmp_path / 'can'}\n")


def test_figures_go_to_a_file_in_a_folder_that_is_there(
    call: Callable[[str], int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(f"stagectl example-pocket --json {tmp_path}/pocket.json") == 0
    assert json.loads((tmp_path / "pocket.json").read_text()) == json.loads(capsys.readouterr().out)
    assert call(f"stagectl example-pocket --json {tmp_path}/absent/pocket.json") == USER_ERROR
    assert "absent is no folder" in capsys.readouterr().err
