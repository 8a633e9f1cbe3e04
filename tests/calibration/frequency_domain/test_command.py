"""`calibrate response` on models of a vibrator, and on a recording."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.__main__ import main
from calibration.frequency_domain.response_model import read_response_model
from ctlblocks import recording
from ctlblocks.recording import Recording
from tests.calibration.frequency_domain.test_identify_response import DAMPING, FREQUENCY, MODES, at, noisy, truth
from tests.calibration.resonant_systems import RATE, order_7
from vibractl.model_file import write_model
from vibractl.transfer_matrix import TransferMatrix


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    monkeypatch.setattr(sys, "argv", ["calibrate", "response", *map(str, arguments)])
    return main()


def model_file(path: Path, lines: np.ndarray, part: float, seed: int, inputs: int = 2) -> Path:
    frequency, response, variance = noisy(truth(2, inputs), lines, part, seed)
    write_model(path, TransferMatrix(frequency, response, variance, np.ones(response.shape), {"rig": "a structure"}))
    return path


def test_modes_of_a_vibrators_model_are_told_written_and_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    low = model_file(tmp_path / "low.h5", FREQUENCY[FREQUENCY < 90], 0.02, 1)
    high = model_file(tmp_path / "high.h5", FREQUENCY[FREQUENCY > 60], 0.02, 2)
    out, told = tmp_path / "modes.h5", tmp_path / "f.json"
    assert call(monkeypatch, low, high, "--out", out, "--json", told, "--png", tmp_path / "png", "--most", 20) == 0
    figures = json.loads(told.read_text())
    ringing = [mode for mode in figures["modes"] if mode["damping"] < 0.5]
    np.testing.assert_allclose([mode["frequency"] for mode in ringing], MODES, rtol=2e-3)
    np.testing.assert_allclose([mode["damping"] for mode in ringing], DAMPING, rtol=0.1)
    assert figures["relative_error_median"] < 0.05
    found = read_response_model(out)
    np.testing.assert_allclose(found.response(FREQUENCY), at(truth(), FREQUENCY), rtol=0.5)
    assert "Frequency response" in out.with_suffix(".html").read_text()
    assert list((tmp_path / "png").rglob("*.png"))


def test_a_recording_is_fitted_by_its_response(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    system, told = order_7(), tmp_path / "f.json"
    drive, response = system.record(40_000, seed=1)
    record = Recording(("u", "y"), ("1", "1"), RATE, np.hstack([drive, response]), {})
    recording.write(tmp_path / "noise.csv", record)
    channels = ("--inputs", "u", "--outputs", "y", "--rate", RATE, "--resolution", RATE / 800)
    assert call(monkeypatch, tmp_path / "noise.csv", *channels, "--order", 7, "--json", told) == 0
    modes = json.loads(told.read_text())["modes"]
    true = system.model.modes
    for frequency, damping in zip(true.frequency, true.damping, strict=True):
        if damping < 0.2:
            assert min(abs(mode["frequency"] / frequency - 1) for mode in modes) < 0.01


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("low.h5", "--order", "some"), "--order is 'some', must be auto or a whole number >= 1"),
        (("low.h5", "--most", "0"), "--most is 0, must be >= 1"),
        (("low.h5", "--band", "300", "400"), "--band is 300 to 400 Hz, must hold bins of 4 to 89.75 Hz"),
        (("low.h5", "one.h5"), "one.h5 is of 1 coils and 2 sensors, must be of 2 and 2 as low.h5 is"),
        (("low.h5", "--inputs", "u"), "--inputs and --outputs are of one recording"),
        (("low.h5", "--rate", "100"), "frequency goes to 89.75 Hz, must be below half the rate, 50 Hz"),
        (("low.h5", "--out", "low.h5"), "low.h5"),
        (("none.h5",), "none.h5: no such model file"),
    ],
)
def test_what_cannot_be_done_is_said(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    reason: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    model_file(Path("low.h5"), FREQUENCY[FREQUENCY < 90], 0.02, 1)
    model_file(Path("one.h5"), FREQUENCY[FREQUENCY < 90], 0.02, 1, inputs=1)
    assert call(monkeypatch, *arguments) == 2
    assert reason in capsys.readouterr().err
