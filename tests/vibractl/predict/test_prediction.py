"""The prediction at the shell: tables, JSON and page, and bad input."""

import json
from pathlib import Path

import pytest

from tests.vibractl.linear_rig import SETTINGS, linear_model
from vibractl.__main__ import main
from vibractl.predict.prediction import RUNS


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    settings = [word for text in SETTINGS for word in ("--set", text)]
    monkeypatch.setattr("sys.argv", ["vibractl", "predict", *settings, *map(str, arguments)])
    return main()


def test_it_tells_drives_lines_and_shots_and_emits_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("vibractl.audio.Line.__enter__", None)
    target, page = tmp_path / "p.json", tmp_path / "p.html"
    settings = ("--shots", 20, "--law", "kalman", "--set", "learning.gains=[]")
    assert call(monkeypatch, "--model", linear_model(tmp_path), *settings, "--json", target, "--report", page) == 0
    out = capsys.readouterr().out
    assert "coil 2, slew, V/s" in out
    assert "learned bins are certified to converge" in out
    assert "law kalman, objective -40 dB: met from shot" in out
    figures = json.loads(target.read_text())
    assert figures["law"] == "kalman"
    assert figures["within_limits"] is True
    assert figures["coils"][0]["peak"]["headroom_db"] > 0
    assert 1 <= figures["objective_met_shot"]["median"] <= 10
    assert len(figures["objective_met_shots"]) == figures["simulated_runs"] == RUNS
    uncertified = figures["uncertified_lines"]
    assert uncertified.pop("outside the model") == 1890  # judged to 2000 Hz, learned to 650, lines 1 / 1.4 Hz apart
    assert figures["certified_lines"] + sum(uncertified.values()) == figures["learned_lines"]
    text = page.read_text()
    assert text.count("<img") == 2
    assert "Not certified does not mean that it diverges" in text


def test_an_objective_never_met_and_a_drive_too_large_are_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    settings = ("--set", "limits.peak=0.1", "--shots", 1, "--json", "-")
    assert call(monkeypatch, "--model", linear_model(tmp_path), *settings) == 0
    streams = capsys.readouterr()
    figures = json.loads(streams.out)
    assert figures["objective_met_shot"] == {"median": None, "10": None, "90": None}
    assert figures["within_limits"] is False
    assert "limits.peak is 0.1 V" in figures["violation"]
    assert "met from shot beyond 1 on" in streams.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--model", "none.h5"), "none.h5: no such model file"),
        (("--model", "model.h5", "--law", "best"), "learning.law"),
        (("--model", "model.h5", "--reference", "chirp:40"), "reference 'chirp:40' is not chirp:F0:F1:SECONDS"),
        (("--model", "model.h5", "--set", "learning.band=[15.0,700.0]"), "the model was measured"),
        (("--model", "model.h5", "--set", "rig.name=other"), "--accept rig.name"),
        (
            ("--model", "model.h5", "--report", "/nowhere/p.html"),
            "--report /nowhere/p.html cannot be: /nowhere is no folder",
        ),
    ],
)
def test_bad_input_is_one_line_and_status_2(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    words: str,
) -> None:
    linear_model(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert call(monkeypatch, *arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
