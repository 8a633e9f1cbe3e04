"""The command `calibrate identify`: files in, model, report and figures out, faults in one line with status 2."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.__main__ import main
from stagectl.models.model_file import read_model
from tests.calibration.resonant_systems import order_7
from tests.shared_data import shared


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("data") / "sweep.csv"
    drive, response = order_7().record(4000, seed=1)
    np.savetxt(path, np.hstack([drive, response]), delimiter=",", header="u [V],y [m]", comments="", fmt="%.9g")
    return path


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str | Path) -> int:
    monkeypatch.setattr(sys, "argv", ["calibrate", "identify", *map(str, arguments)])
    return main()


def test_it_writes_model_report_figures_and_json(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model.h5"
    files = ("--out", out, "--png", tmp_path / "png", "--json", tmp_path / "figures.json")
    assert call(monkeypatch, table, "--inputs", "u", "--outputs", "y", "--rate", "1000", *files) == 0
    model = read_model(out, 1000.0, ["u"], ["y"])
    assert model.order == 7
    assert model.input_units == ("V",)
    assert str(table) in model.provenance["recording"]
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert figures["order"] == 7
    assert figures["modes"][1]["frequency_hz"] == pytest.approx(62.0, rel=0.005)
    assert 0 < figures["modes"][1]["damping_error"] < 0.001
    assert figures["held_back"]["outputs"]["y"]["free_run_nrmse"] > 85
    assert "Singular values" in out.with_suffix(".html").read_text()
    names = {path.name for path in (tmp_path / "png").iterdir()}
    assert names == {"singular-values.png", "orders.png", "free-run-on-validation-data.png", "residuals.png"}
    printed, told = capsys.readouterr()
    assert "natural frequency" in printed
    assert "residuals one step ahead are" in printed
    assert "identifying 100 %" in told


def test_a_time_series_is_judged_by_its_prediction_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pushed, series = np.random.default_rng(3).standard_normal(3000), np.zeros(3002)
    for sample, push in enumerate(pushed, 2):
        series[sample] = 1.6 * series[sample - 1] - 0.9 * series[sample - 2] + push
    path, out = tmp_path / "series.csv", tmp_path / "series.h5"
    np.savetxt(path, series, header="y", comments="")
    files = ("--out", out, "--png", tmp_path / "png", "--json", tmp_path / "figures.json")
    assert call(monkeypatch, path, "--inputs", "none", "--outputs", "y", "--rate", "500", *files) == 0
    model = read_model(out, 500.0, [], ["y"])
    assert model.poles == pytest.approx(np.roots([1.0, -1.6, 0.9]), abs=0.03)
    figures = json.loads((tmp_path / "figures.json").read_text())["held_back"]
    share = 100 * (1 - 1 / np.std(series))  # the pushes are all that nobody can foretell
    assert figures["outputs"]["y"]["one_step_nrmse"] == pytest.approx(share, abs=3.0)
    assert not [name for name in (*figures, *figures["outputs"]["y"]) if "free" in name or "cross" in name]
    assert "prediction-on-validation-data.png" in {each.name for each in (tmp_path / "png").iterdir()}
    said = capsys.readouterr().out
    assert "free run" not in said
    assert "drive" not in said


def test_how_long_much_data_takes_is_said_beforehand(
    table: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("calibration.identification.command.LARGE", 7_999)
    assert call(monkeypatch, table, "--inputs", "u", "--outputs", "y", "--rate", "1000", "--order", "3") == 0
    assert capsys.readouterr().err.startswith("identifying: 4000 samples of 2 channels; 250 000 samples of four take")


@pytest.mark.slow
def test_columns_go_by_number_and_figures_to_the_standard_output(
    table: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ("--inputs", "1", "--outputs", "2", "--rate", "1000", "--order", "3", "--horizon", "20")
    assert call(monkeypatch, table, *arguments, "--method", "pem", "--json", "-") == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["order"] == 3
    assert "order 3 by pem" in printed.err


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        (("--rate", "-1"), "--rate is -1.0"),
        (("--order", "many"), "--order is 'many'"),
        (("--inputs", "z"), "no channel 'z'; there are u, y"),
        (("--inputs", "y"), "y: cannot be input and output at once"),
        (("--inputs", "u,"), "--inputs is 'u,'"),
        (("--out", "nowhere/model.h5"), "cannot be: nowhere is no folder"),
        (("--out", "model.txt"), "must be '.h5'"),
        (("--method", "arx"), "method is 'arx'"),
        (("--horizon", "9000"), "too few"),
        (("--delay", "1,x"), "--delay is '1,x', must be auto, samples >= 0 of all inputs"),
        (("--delay", "1,2"), "delay has 2 entries, must be one number or one for each of 1 inputs"),
        (("--detrend", "line"), "--detrend is 'line', must be one of mean, record, linear, slow, none"),
        (("--hold-back", "2"), "the validation share is 2.0"),
    ],
)
def test_a_fault_is_one_line_and_status_2(
    table: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    wrong: tuple[str, str],
    complaint: str,
) -> None:
    given = {"--inputs": "u", "--outputs": "y", "--rate": "1000"} | dict([wrong])
    assert call(monkeypatch, table, *(part for pair in given.items() for part in pair)) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert said.count("\n") == 1


def test_what_is_there_is_refused_before_anything_is_identified(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "model.html").write_text("mine")
    out = ("--rate", "1000", "--out", tmp_path / "model.h5")
    assert call(monkeypatch, table, "--inputs", "u", "--outputs", "y", *out) == 2
    said = capsys.readouterr().err
    assert "model.html: is there already" in said
    assert "identifying" not in said


def test_an_unstable_plant_is_named_and_identified_as_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    random, path = np.random.default_rng(2), tmp_path / "falls.csv"
    u, y = random.standard_normal(400), np.zeros(400)
    for k in range(1, 400):
        y[k] = 1.01 * y[k - 1] + 0.3 * u[k - 1] + 0.01 * random.standard_normal()
    np.savetxt(path, np.column_stack([u, y]), delimiter=",", header="u,y", comments="")
    given = (path, "--inputs", "u", "--outputs", "y", "--rate", "100")
    assert call(monkeypatch, *given) == 0
    assert "take stable=False (--unstable)" in capsys.readouterr().out
    assert call(monkeypatch, *given, "--unstable", "--no-direct", "--out", tmp_path / "m.h5") == 0
    said, model = capsys.readouterr().out, read_model(tmp_path / "m.h5", 100.0)
    assert "the model is not stable" in said
    assert "nan" not in said
    assert "nan %" not in (tmp_path / "m.html").read_text()
    assert model.poles[0] == pytest.approx(1.01, abs=0.002)
    assert not model.D.any()


def test_a_bad_file_is_one_line_and_status_2(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.csv"
    path.write_text("u,y\n1,2\n3\n")
    assert call(monkeypatch, path, "--inputs", "u", "--outputs", "y", "--rate", "1") == 2
    assert "row 3 has 1 cells, must have 2" in capsys.readouterr().err
    assert call(monkeypatch, tmp_path / "none.csv", "--inputs", "u", "--outputs", "y") == 2
    assert "no such file" in capsys.readouterr().err


def test_a_measured_oscillator_is_identified(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The silverbox: 131 072 rows of two columns without names."""
    path = shared("silverbox/SNLS80mV.csv")
    arguments = ("--inputs", "1", "--outputs", "2", "--rate", "610.35", "--order", "2", "--json", "-")
    assert call(monkeypatch, path, *arguments) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures["is_stable"]
    assert figures["held_back"]["outputs"]["channel_2"]["free_run_nrmse"] > 80
