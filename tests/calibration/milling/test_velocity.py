"""`calibrate velocity`: the model that force control is designed from."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.__main__ import main
from calibration.milling.velocity import identify_velocity
from ctlblocks import recording
from ctlblocks.recording import Recording
from stagectl.experiments.feed.free_run import HELD, MEAN, STEP, steps
from stagectl.models.model_file import read_model
from stagectl.robot.milling.nominal_velocity import nominal_velocity


def record(noise: float = 1e-4) -> Recording:
    """Return 16 s of the nominal model, with noise on what is measured."""
    model, drive = nominal_velocity(250.0), steps(16.0, 2, 250.0)[:, None]
    seen = model.simulate(drive, np.zeros(model.order)) + noise * np.random.default_rng(3).standard_normal(drive.shape)
    return Recording(("velocity_reference", "velocity"), ("m/s", "m/s"), 250.0, np.hstack([drive, seen]))


def calibrate(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["calibrate", *words])
    return main()


def test_the_poles_of_a_known_model_are_found_without_a_direct_term() -> None:
    found = identify_velocity(record())
    np.testing.assert_allclose(np.sort(found.model.poles), np.sort(nominal_velocity(250.0).poles), atol=0.02)
    assert found.model.D[0, 0] == 0.0
    assert found.fresh.free_run.nrmse[0] > 98.0


def test_the_steps_go_back_and_forth_about_where_they_begin() -> None:
    feed = steps(24.0, 1, 250.0)
    place = np.cumsum(feed) / 250.0
    assert np.abs(place).max() < 35e-3
    assert set(np.round(np.abs(feed), 6)) == {MEAN - STEP, MEAN + STEP}
    changes = np.flatnonzero(np.diff(feed))
    assert (np.diff(changes) % round(HELD * 250.0) == 0).all()


def test_the_command_writes_record_and_model_of_the_simulated_robot(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, figures = tmp_path / "velocity.h5", tmp_path / "figures.json"
    assert calibrate(monkeypatch, "velocity", "--out", str(out), "--seconds", "8", "--json", str(figures)) == 0
    first, *_, last = capsys.readouterr().err.splitlines()
    assert first.startswith("steps: 8 s of them")
    assert last.startswith("steps 100 %")
    assert json.loads(figures.read_text())["fresh_fit"] > 88.0
    assert read_model(out, rate=250.0).order == 3
    again = tmp_path / "again.h5"
    assert calibrate(monkeypatch, "velocity", "--out", str(again), "--from", str(out.with_suffix(".csv"))) == 0
    np.testing.assert_allclose(read_model(again).A, read_model(out).A)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--axis", "z"], "--axis is 'z', must be one of x, y"),
        (["--seconds", "1"], "--seconds is 1, must be 4 to 600"),
        (["--from", "RECORD"], "no channel 'velocity_reference'"),
    ],
)
def test_a_mistake_is_one_line_and_status_2_and_leaves_no_model(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: list[str], text: str
) -> None:
    other = tmp_path / "other.csv"
    recording.write(other, Recording(("speed",), ("m/s",), 250.0, np.ones((10, 1))))
    out = tmp_path / "velocity.h5"
    words = [str(other) if word == "RECORD" else word for word in words]
    assert calibrate(monkeypatch, "velocity", "--out", str(out), *words) == 2
    assert text in capsys.readouterr().err
    assert not out.exists()
