"""A learned drive that would break a limit of the guard."""

from dataclasses import replace
from pathlib import Path

import pytest

from ctlblocks import recording
from rigkit.run_folder import read_events
from tests.vibractl.linear_rig import RATE, linear_config, linear_matrix
from vibractl.loudness import QUANTITIES, drive_sizes
from vibractl.model_file import read_model, write_model
from vibractl.replay import replay
from vibractl.run_setup import create, setup_of, shot_files
from vibractl.session import Session
from vibractl.setup import setup
from vibractl.shot_file import split


@pytest.mark.sample(1)
@pytest.mark.parametrize("limit", ["peak", "rms", "slew"])
def test_a_step_that_would_break_a_limit_is_taken_as_far_as_it_fits(tmp_path: Path, limit: str) -> None:
    """The model is of a vibrator twice as loud: drives must double, and may grow by a tenth."""
    write_model(tmp_path / "loud.h5", replace(linear_matrix(), response=2 * linear_matrix().response))
    first = setup(linear_config(), read_model(tmp_path / "loud.h5")).learner().drive
    column = [name for name, _ in QUANTITIES].index(limit)
    allowed = 1.1 * drive_sizes(first, linear_config().limits, RATE)[:, column].max()
    config = linear_config(f"limits.{limit}={allowed}", "session.check=false", "limits.ramp=0.05")
    folder, made = create(tmp_path / "run", config, tmp_path / "loud.h5")
    with folder:
        Session(folder, made).run(5, lambda *_: None, lambda: False)
    held = [event for event in read_events(tmp_path / "run") if event["event"] == "drive_held_back"]
    assert [event["limit"] for event in held] == [limit] * 5
    drives = [split(recording.read(path), linear_config())[0] for path in shot_files(tmp_path / "run")]
    sizes = [drive_sizes(drive, linear_config().limits, RATE).max(axis=0) for drive in drives]
    assert all(size[column] <= allowed for size in sizes)
    assert sizes[-1][column] > (0.85 if limit == "rms" else 0.97) * allowed  # a mean outlasts the silence
    assert all(each.identical for each in replay(tmp_path / "run", setup_of(tmp_path / "run")))
