import json
import sys
from pathlib import Path

import pytest

from calibration.__main__ import main
from vibractl.model_file import read_model

SHORT = ("band=[60, 67]", "settle=0.05", "tone=0.2")


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str | Path) -> int:
    settings = [part for text in SHORT for part in ("--set", f"characterisation.{text}")]
    quiet = ["--set", "audio.isolated=false"]
    monkeypatch.setattr(sys, "argv", ["calibrate", "vibrator", *settings, *quiet, *map(str, arguments)])
    return main()


def test_it_writes_model_recordings_report_and_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "model.h5"
    assert call(monkeypatch, "--out", model, "--json", tmp_path / "figures.json", "--png", tmp_path / "png") == 0
    figures = json.loads((tmp_path / "figures.json").read_text())
    matrix = read_model(model, "simulated-vibrator", (2, 2))
    assert figures["lines"] == len(matrix.frequency)
    assert (tmp_path / "model.raw" / "pass-2-000.wav").is_file()
    assert "Refined grid" in (tmp_path / "model.html").read_text()
    assert (tmp_path / "png" / "transfer-matrix.png").is_file()
    assert "least certain" in capsys.readouterr().out


def test_called_again_it_takes_the_recordings_that_are_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = tmp_path / "model.h5"
    arguments = ("--out", model, "--passes", "1", "--no-preload", "--seed", "2")
    assert call(monkeypatch, *arguments) == 0
    first, times = read_model(model), [path.stat().st_mtime_ns for path in (tmp_path / "model.raw").glob("*.wav")]
    model.unlink()
    assert call(monkeypatch, *arguments) == 0
    assert (read_model(model).response == first.response).all()
    assert [path.stat().st_mtime_ns for path in (tmp_path / "model.raw").glob("*.wav")] == times


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--out", "nowhere/model.h5"), "there is no folder nowhere"),
        (("--out", "model.txt"), "must be '.h5'"),
        (("--out", "model.h5", "--passes", "3"), "passes"),
        (("--out", "model.h5", "--set", "characterisation.probe=-1"), "-1"),
        (("--out", "model.h5", "--set", "characterisation.prob=1"), "prob"),
        (("--out", "model.h5", "--config", "no.toml"), "no.toml"),
        (("--out", "model.h5", "--set", "characterisation.band=[15, 20000]"), "20000"),
        (("--out", "model.h5", "--set", "characterisation.step=3"), "must be <= 2.33333 Hz for 4 lines"),
        (("--out", "taken.h5"), "taken.h5"),
    ],
)
def test_bad_input_is_one_line_and_status_2_and_writes_nothing(
    arguments: tuple[str, ...],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken.h5").write_text("not a model")
    assert call(monkeypatch, *arguments) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["taken.h5"]


def test_a_drive_beyond_the_limits_is_refused_before_anything_is_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "--out", tmp_path / "m.h5", "--set", "characterisation.preload=9.5") == 2
    assert (
        "characterisation.preload + characterisation.probe is 9.6 V, must be <= limits.peak" in capsys.readouterr().err
    )
    assert list(tmp_path.iterdir()) == []
