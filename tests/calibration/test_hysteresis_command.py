"""The command `calibrate hysteresis`: a record in, a model with an inverse, a report and figures out."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.__main__ import main
from stagectl.stage.hysteresis import HysteresisModel, respond
from stagectl.stage.hysteresis_file import read_hysteresis
from tests.shared_data import shared


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a record of 10 s at 200 Hz: 0 to 100 V, some 30 um, loops of a fifth."""
    path = tmp_path_factory.mktemp("data") / "loops.csv"
    time = np.arange(2_000) / 200.0
    voltage = 50 - 50 * np.cos(2 * np.pi * time) * np.minimum(1, time / 5)
    parts = np.array([0, 1e-5, 0, 0]), np.zeros(2), np.zeros(2), np.array([0.2, 0.5]), np.array([5e-6, 4e-6])
    moved = 1e6 * respond(HysteresisModel(0.0, 100.0, *parts, 200.0, delay=1), voltage)
    columns = np.column_stack([voltage, moved])
    np.savetxt(path, columns, delimiter=",", header="u [V],y [um]", comments="", fmt="%.9g")
    return path


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str | Path) -> int:
    monkeypatch.setattr(sys, "argv", ["calibrate", "hysteresis", *map(str, arguments)])
    return main()


def test_it_writes_model_report_figures_and_json(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "stack.h5"
    files = ("--out", out, "--png", tmp_path / "png", "--json", tmp_path / "figures.json")
    assert call(monkeypatch, table, "--input", "u", "--output", "y", "--rate", "200", *files) == 0
    model = read_hysteresis(out)
    assert model.rate == 200.0
    assert model.provenance["recording"] == str(table)
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert figures["held_back_nrmse_percent"] > 99.5
    assert figures["straight_line_nrmse_percent"] < 95
    assert 0.1 < figures["opening_of_span"] < 0.3
    assert "What is left" in out.with_suffix(".html").read_text()
    assert {path.name for path in (tmp_path / "png").iterdir()} == {"loops.png", "what-is-left.png", "model.png"}
    assert "validation" in capsys.readouterr().out


def test_the_record_of_a_stack_is_read_as_it_was_published(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Columns without names, um and no rate in the file; fitted to rows 1000 to 4014, judged on the other half.

    The measured loop opens by 23 % of the span, of which a delay of one sample at 1 Hz makes 3.
    """
    record, out = shared("piezo/Model_Vi_Do.dat"), tmp_path / "picma.h5"
    columns = ("--input", "1", "--output", "5", "--rate", "200", "--unit", "um")
    arguments = (*columns, "--skip", "5", "--hold-back", "0.5", "--out", out, "--json", "-")
    assert call(monkeypatch, record, *arguments) == 0
    printed = capsys.readouterr()
    figures = json.loads(printed.out)
    assert figures["held_back_nrmse_percent"] > 98.6
    assert figures["opening_of_span"] == pytest.approx(0.20, abs=0.01)
    assert "straight line" in printed.err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("--out", "stack.wav"), "stack.wav: the suffix is '.wav', must be '.h5'"),
        (("--out", "nowhere/stack.h5"), "cannot be: nowhere is no folder"),
        (("--unit", "inch"), "--output: the unit is 'inch', must be one of m, mm, um"),
        (("--skip", "9"), "--skip is 9 s, must be less than the 7 s that are fitted"),
        (("--hold-back", "1"), "--hold-back is 1, must be 0.05 to 0.9"),
        (("--plays", "0"), "plays is 0, must be 1 to 200"),
        (("--input", "w"), "no channel 'w'"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_status_2(
    change: tuple[str, str],
    words: str,
    table: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    usual = {"--input": "u", "--output": "y", "--rate": "200", "--out": "stack.h5"} | dict([change])
    assert call(monkeypatch, table, *(part for pair in usual.items() for part in pair)) == 2
    printed = capsys.readouterr()
    assert words in printed.err
    assert printed.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
