"""A first drive that the limits leave no room is refused with what it needs, or emitted at the level that fits."""

from pathlib import Path

import numpy as np
import pytest
import soundfile

from rigkit import config as rig_file
from tests.vibractl.linear_rig import linear_matrix
from vibractl.config import Limits, RigConfig
from vibractl.guard import violation
from vibractl.loudness import ROOM, at_level, drive_sizes, fitting_level, too_loud
from vibractl.model_file import write_model
from vibractl.run_setup import create

RATE = 44_100.0
LIMITS = Limits()
TIME = np.arange(44_100) / RATE
SINE = np.sin(2 * np.pi * 60 * TIME)[:, None] * np.hanning(len(TIME))[:, None] * [1.0, 0.3]


@pytest.mark.parametrize("limit", ["peak", "rms", "slew"])
def test_a_drive_at_the_level_that_fits_keeps_all_limits_and_a_louder_one_breaks_one(limit: str) -> None:
    place = ["peak", "rms", "slew"].index(limit)
    tight = LIMITS.model_copy(update={limit: 0.5 * drive_sizes(SINE, LIMITS, RATE)[0, place]})
    level = fitting_level(SINE, tight, RATE)
    assert level == pytest.approx(0.5)
    assert violation(SINE * level * (1 - 1e-9), tight, RATE) is None
    broken = violation(SINE * level * 1.001, tight, RATE)
    assert broken is not None
    assert broken.limit == limit


def test_silence_fits_at_any_level() -> None:
    assert fitting_level(0.0 * SINE, LIMITS, RATE) == np.inf
    assert too_loud(0.0 * SINE, LIMITS, RATE) == ""


def test_what_breaks_a_limit_says_what_is_needed() -> None:
    told = too_loud(SINE * 18.0, LIMITS, RATE)
    assert told.startswith("drive 1 asks for ")
    assert told.endswith("limits.peak is 9 V; it needs 18 V, and fits at 0.5 of its level")
    assert "must be finite" in too_loud(np.full((9, 1), np.nan), LIMITS, RATE)


def loud(amplitude: float, signal: str = "chirp:40:90:1") -> RigConfig:
    return rig_file.load(None, RigConfig, (f"reference.signal={signal}", f"reference.amplitude={amplitude}"))


def test_a_run_refuses_a_first_drive_that_is_too_loud_or_fits_its_amplitude(tmp_path: Path) -> None:
    model = tmp_path / "m.h5"
    write_model(model, linear_matrix())
    with pytest.raises(ValueError, match=r"it needs .* V, and fits at .*amplitude is 9000 m/s\^2\); --fit"):
        create(tmp_path / "run", loud(9_000.0), model)
    assert not (tmp_path / "run").exists()
    folder, made = create(tmp_path / "run", loud(9_000.0), model, fit_amplitude=True)
    folder.close()
    assert fitting_level(made.learner().drive, made.config.limits, RATE) == pytest.approx(1 / ROOM, rel=0.01)
    assert f"reference.amplitude is {made.config.reference.amplitude:g} m/s^2, " in made.said[0]
    assert f"amplitude = {made.config.reference.amplitude}" in (tmp_path / "run" / "config.toml").read_text()


def test_an_amplitude_that_leaves_room_is_not_changed(tmp_path: Path) -> None:
    model = tmp_path / "m.h5"
    write_model(model, linear_matrix())
    folder, made = create(tmp_path / "run", loud(0.5), model, fit_amplitude=True)
    folder.close()
    assert made.config.reference.amplitude == 0.5


def test_of_a_file_its_full_scale_is_fitted_and_one_with_units_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "r.wav"
    soundfile.write(file, SINE[:, :1], 44_100, "PCM_16")
    config = rig_file.load(None, RigConfig, (f"reference.signal={file}", "reference.full_scale=10"))
    assert at_level(config, 0.25).reference.full_scale == 2.5
    with pytest.raises(ValueError, match="which says its own units: multiply it by 0.25 at most"):
        at_level(rig_file.load(None, RigConfig, (f"reference.signal={file}",)), 0.25)
