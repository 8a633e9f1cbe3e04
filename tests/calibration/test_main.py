import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from calibration.__main__ import main
from vibractl.model_file import read_model, write_model

SHORT = ("method=stepped", "band=[60, 67]", "settle=0.05", "tone=0.2")


MULTISINE = ("--method", "multisine", *(
    part for text in ("band=[100, 160]", "records=4", "period=2", "run_in=0.3")
    for part in ("--set", f"characterisation.{text}")
))  # fmt: skip


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
    matrix = read_model(model, (2, 2))
    assert figures["lines"] == len(matrix.frequency)
    assert (tmp_path / "model.raw" / "pass-2-000.wav").is_file()
    assert "Refined grid" in (tmp_path / "model.html").read_text()
    assert (tmp_path / "png" / "transfer-matrix.png").is_file()
    assert "least certain" in capsys.readouterr().out


def test_by_multisine_it_says_how_long_it_emitted_and_draws_noise_and_distortion(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "model.h5"
    arguments = (*MULTISINE, "--json", tmp_path / "figures.json", "--png", tmp_path / "png")
    assert call(monkeypatch, "--out", model, *arguments) == 0
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert figures["identification_seconds"] == pytest.approx(4 * 2.4)
    assert figures["loudest_line_db"] < 0
    assert len(figures["levels_db"]) == 4  # two bands, two responses
    assert "Noise and distortion" in (tmp_path / "model.html").read_text()
    assert (tmp_path / "png" / "noise-and-distortion.png").is_file()
    assert "bins from 9.6 s of" in " ".join(capsys.readouterr().out.split())
    assert len(list((tmp_path / "model.raw").glob("multisine-*.wav"))) == 5


@pytest.mark.slow
def test_two_models_are_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for seed in ("1", "2"):
        assert call(monkeypatch, "--out", tmp_path / f"{seed}.h5", *MULTISINE, "--seed", seed) == 0
    files = (str(tmp_path / "1.h5"), str(tmp_path / "2.h5"))
    outputs = ("--json", str(tmp_path / "c.json"), "--out", str(tmp_path / "c.html"), "--png", str(tmp_path / "png"))
    monkeypatch.setattr(sys, "argv", ["calibrate", "compare", *files, *outputs])
    capsys.readouterr()
    assert main() == 0
    figures = json.loads((tmp_path / "c.json").read_text())
    assert figures["lines"] == len(figures["frequency_hz"]) == 121
    assert figures["mean_normalised_difference"] > 10
    assert (tmp_path / "png" / "difference.png").is_file()
    assert "Two models compared" in (tmp_path / "c.html").read_text()
    assert "farthest apart" in capsys.readouterr().out


def test_models_of_different_rigs_are_not_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "--out", tmp_path / "tank.h5", *MULTISINE, "--set", "rig.name=tank") == 0
    tank = read_model(tmp_path / "tank.h5")
    write_model(tmp_path / "ship.h5", replace(tank, provenance={**tank.provenance, "rig": "ship"}))
    monkeypatch.setattr(sys, "argv", ["calibrate", "compare", str(tmp_path / "tank.h5"), str(tmp_path / "ship.h5")])
    capsys.readouterr()
    assert main() == 2
    assert "was measured on rig 'tank'" in capsys.readouterr().err


@pytest.mark.slow
def test_computed_again_it_takes_the_recordings_that_are_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = tmp_path / "model.h5"
    arguments = ("--out", model, "--passes", "1", "--no-preload", "--seed", "2")
    assert call(monkeypatch, *arguments) == 0
    first, times = read_model(model), [path.stat().st_mtime_ns for path in (tmp_path / "model.raw").glob("*.wav")]
    model.unlink()
    assert call(monkeypatch, *arguments, "--recompute") == 0
    assert (read_model(model).response == first.response).all()
    assert [path.stat().st_mtime_ns for path in (tmp_path / "model.raw").glob("*.wav")] == times


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--out", "nowhere/model.h5"), "cannot be: nowhere is no folder"),
        (("--out", "model.txt"), "must be '.h5'"),
        (("--out", "model.h5", "--passes", "3"), "passes"),
        (("--out", "model.h5", "--method", "noise"), "noise"),
        (("--out", "model.h5", "--method", "multisine", "--set", "characterisation.records=2"), "must be > 2"),
        (("--out", "model.h5", "--set", "characterisation.probe=-1"), "-1"),
        (("--out", "model.h5", "--set", "characterisation.prob=1"), "prob"),
        (("--out", "model.h5", "--config", "no.toml"), "no.toml"),
        (("--out", "model.h5", "--set", "characterisation.band=[15, 20000]"), "20000"),
        (("--out", "model.h5", "--set", "characterisation.step=3"), "must be <= 2.33333 Hz for 4 bins"),
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
