"""Drives and responses in two files, by two clocks or begun apart: found, told, refused, taken out."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.io import wavfile

from calibration.__main__ import main
from calibration.identification.beginnings import FEW, beginning
from stagectl.models.model_file import read_model
from tests.calibration.identification.plain_scipy import RATE, off, response, white

FREQUENCY = np.linspace(10, 200, 100)
SAMPLES, FULL_SCALE, PPM = 20_000, 32.0, 40.0
NAMES = ["drive_1", "drive_2"], ["response_1", "response_2"]


def recorded(heard: np.ndarray, ppm: float) -> np.ndarray:
    """Return what a recorder hears whose clock is so much faster."""
    at = np.arange(len(heard)) / (1 + 1e-6 * ppm)
    return np.asarray(make_interp_spline(np.arange(len(heard)), heard, k=5)(at))


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("two devices")
    drive = white(3, SAMPLES)
    heard = response(drive)
    rest = np.zeros((60, 2))
    files = {
        "drive": drive, "same": heard, "clock": recorded(heard, PPM), "late": np.vstack((rest, heard[:-60])),
        "early": heard[60:], "both": np.vstack((rest, recorded(heard, -PPM)[:-60])),
    }  # fmt: skip
    for name, signal in files.items():
        wavfile.write(folder / f"{name}.wav", RATE, (signal / FULL_SCALE).astype(np.float32))
    return folder


def identified(lab: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, *words: str) -> int:
    files = ["--from", str(lab / "drive.wav"), str(lab / f"{name}.wav"), "--out", str(folder / "m.h5")]
    monkeypatch.setattr(sys, "argv", ["calibrate", "identify", *files, "--order", "8", "--horizon", "20", *words])
    return main()


@pytest.mark.parametrize("ppm", [0.0, 5.0, -150.0])
def test_a_clock_is_found_with_its_error(ppm: float) -> None:
    drive = white(4, SAMPLES)
    found = beginning(drive, recorded(response(drive, 0.1), ppm)).drift
    assert abs(1e6 * found.value - ppm) < 4e6 * found.error < 4.0
    assert found.is_told == (ppm != 0)


def test_signals_too_short_or_unlike_show_no_clock_and_no_delay() -> None:
    drive = white(5, SAMPLES)
    for found in (beginning(drive[:1_500], response(drive)[:1_500]), beginning(drive, white(6, SAMPLES))):
        assert found.late in range(-1, 4)
        assert not found.drift.is_told


@pytest.mark.slow
def test_another_clock_is_refused_until_it_is_corrected(
    lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert identified(lab, tmp_path, monkeypatch, "clock") == 2
    assert f"clock.wav: the recorder's clock is {PPM:.0f}.0" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    assert identified(lab, tmp_path, monkeypatch, "clock", "--correct-clock") == 0
    assert "faster, which is taken out" in capsys.readouterr().out
    assert g_off(tmp_path) < 0.05


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize(("name", "place"), [("late", "after"), ("early", "before"), ("both", "after")])
def test_a_delay_is_told_and_taken_out_if_asked(
    lab: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    name: str,
    place: str,
) -> None:
    if name != "both":
        assert identified(lab, tmp_path, monkeypatch, name) == 0
        told = capsys.readouterr().out
        assert f"{place} their drives, " in told
        assert "--correct-clock" in told
    assert identified(lab, tmp_path, monkeypatch, name, "--correct-clock", "--order", "auto", "--again") == 0
    assert f"which is taken out but for {FEW} samples" in capsys.readouterr().out
    assert g_off(tmp_path) < 0.1


@pytest.mark.slow
def test_one_clock_and_one_beginning_are_left_as_they_are(
    lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert identified(lab, tmp_path, monkeypatch, "same") == 0
    printed = capsys.readouterr().out
    assert "clock is" not in printed
    assert "their drives" not in printed
    assert "moved" not in read_model(tmp_path / "m.h5", RATE, *NAMES).provenance
    (tmp_path / "a").mkdir()
    assert identified(lab, tmp_path / "a", monkeypatch, "same", "--correct-clock") == 0
    one, other = ((folder / "m.h5") for folder in (tmp_path, tmp_path / "a"))
    np.testing.assert_array_equal(read_model(one, RATE, *NAMES).A, read_model(other, RATE, *NAMES).A)


def g_off(folder: Path) -> float:
    """Return how far a model is off, but for the samples of delay that fit it best."""
    found = read_model(folder / "m.h5", RATE, *NAMES).frequency_response(FREQUENCY)
    turns = (np.exp(2j * np.pi * FREQUENCY * samples / RATE)[:, None, None] for samples in range(FEW + 3))
    return min(off(found * turn, FREQUENCY) for turn in turns)
