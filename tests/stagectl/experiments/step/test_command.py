"""`stagectl step`: simulated, recorded, reported, replayed, stopped, killed, and refused."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ctlblocks.recording import read
from rigkit.config import load
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import reported
from rigkit.run_folder import read_events
from stagectl.__main__ import main
from stagectl.experiments.step.experiment import STEPS
from stagectl.robot.config import CellConfig
from tests.until import until

SHORT = ("--period", "2", "--repeats", "3")


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str | Path) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", *map(str, arguments)])
    return main()


def test_the_lines_that_are_printed_go_into_a_rig_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "step", *SHORT, "--set", "midranging.simulator.options.time_constant=0.3") == 0
    printed = capsys.readouterr().out
    file = tmp_path / "cell.toml"
    file.write_text(printed[printed.index("[midranging.pair]") :], encoding="utf-8")
    pair = load(str(file), CellConfig).midranging.pair
    assert pair.slow_outputs == (pytest.approx(np.exp(-1 / 75), abs=1e-4),)
    assert pair.fast_inputs == (pytest.approx(1.0 - pair.fast_outputs[0], abs=1e-3),)
    assert 0.0 <= pair.slow_delay < 1e-3
    assert "slow_delay = " in printed


@pytest.mark.parametrize("kind", ["step", "multisine"])
def test_the_simulated_pair_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    """The stage: a gain of 5/s and a process of 2 in a loop, 0.1 s; the robot: told, 0.3 s."""
    run, told = tmp_path / "run", tmp_path / "found.json"
    wanted = (*SHORT, "--kind", kind, "--set", "midranging.simulator.options.time_constant=0.3")
    assert call(monkeypatch, "step", *wanted, "--out", run, "--json", told, "--png", tmp_path / "png") == 0
    found = json.loads(told.read_text())
    assert (found["stage"]["gain"], found["robot"]["gain"]) == (
        pytest.approx(1.0, abs=5e-3),
        pytest.approx(1.0, abs=5e-3),
    )
    assert found["stage"]["time_constant"] == pytest.approx(0.098, abs=1e-3)
    assert found["robot"]["time_constant"] == pytest.approx(0.3, abs=2e-3)
    assert found["robot"]["bandwidth"] == pytest.approx(0.53, abs=0.01)
    assert found["robot"]["terms"]["outputs"] == [pytest.approx(np.exp(-1 / 75), abs=1e-4)]
    assert max(found[name]["delay"] for name in ("robot", "stage")) < 1e-3
    assert all(each.identical for each in replayed(run, STEPS))
    assert json.loads(json.dumps(reported(run, STEPS))) == json.loads((run / "summary.json").read_text())
    assert {path.name for path in (tmp_path / "png").iterdir()} == {"responses-1.png", "responses-2.png"}
    assert json.loads((run / "run.json").read_text())["kind"] == "step responses"
    assert call(monkeypatch, "replay", run) == 0


@pytest.mark.slow
def test_what_was_recorded_before_a_kill_is_reported_and_replayed(tmp_path: Path) -> None:
    path = tmp_path / "run"
    command = [sys.executable, "-m", "stagectl", "step", "--out", str(path), "--repeats", "100", "--of", "robot"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    growing, frame = path / "steps.part.wav", 8 * 7
    try:
        until(lambda: growing.exists() and growing.stat().st_size > 30 * 250 * frame)
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    found = reported(path, STEPS)
    assert found["robot"]["gain"] == pytest.approx(1.0, abs=1e-3)
    assert found["ended_early"] == {"": "killed"}
    assert all(each.identical for each in replayed(path, STEPS))
    assert [each["event"] for each in read_events(path)] == ["started"]
    assert len(read(path / "steps.wav").data) >= 30 * 250


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--size", "-1"), "size is -1.0, must be > 0 and <= 0.1 m"),
        (("--kind", "impulse"), 'kind is "impulse", must be "step" or "multisine"'),
        (("--of", "arm"), 'of is "arm", must be "both" or "robot" or "stage"'),
        (("--repeats", "1"), "repeats is 1, must be >= 2 and <= 100 periods"),
        (("--of", "stage", "--size", "0.05"), "size is 0.05 m, must be <= midranging.pair.travel, 0.025 m"),
        (("--kind", "multisine", "--highest", "0.1"), "highest is 0.1 Hz, must be >= 0.375 Hz: three bins"),
        (("--png", "pictures"), "--png goes with --out RUN/, which is not given"),
        (("--live", "--set", "midranging.pair.rate=100"), "a live run has the axes x at midranging.pair.rate 100"),
    ],
)
def test_what_cannot_be_asked_is_refused_in_a_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], said: str
) -> None:
    assert call(monkeypatch, "step", *arguments) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith(f"error: {said}")
    assert captured.err.count("\n") == 1


def test_a_recording_of_another_program_s_folder_says_what_is_missing(tmp_path: Path) -> None:
    (tmp_path / "config.toml").write_text("")
    with pytest.raises(ValueError, match="does not say what was asked"):
        reported(tmp_path, STEPS)
