"""Runs and calibrations for which the disk has no room end with status 2 and one line, and leave nothing behind.

Guards against runs that learn of a full disk when the machine has moved already.
"""

import importlib
from pathlib import Path

import pytest

from stagectl.models.model_file import write_model
from stagectl.robot.milling.milling_models import write_milling
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from tests.rigkit.test_disk_space import leave
from tests.stagectl.daemon.cell.bench import QUICK as TRIALS
from tests.stagectl.experiments.feed.small_pocket import QUICK as POCKET
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.experiments.toroid.short_cell import SHORT
from tests.stagectl.robot.milling.test_milling_models import models
from tests.vibractl.linear_rig import SETTINGS, linear_model
from vibractl.audio import Line

LONG = ("pocket.feed=6e-3",)
COMMANDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "vibractl run --model model.h5 --out new/run --shots 2": ("vibractl", tuple(SETTINGS)),
    "calibrate vibrator --out found.h5": ("calibration", tuple(SETTINGS)),
    "calibrate vibrator --method stepped --out found.h5": ("calibration", tuple(SETTINGS)),
    "stagectl run --model x.h5 --model y.h5 --model z.h5 --out new/run": ("stagectl", ()),
    "calibrate stage --axis x --out found.h5": ("calibration", ()),
    "stagectl cell --setup B --out new/run": ("stagectl", SHORT),
    "stagectl ilc --model milling.h5 --out new/run": ("stagectl", TRIALS),
    "stagectl force --task slot --out new/run": ("stagectl", POCKET),
    "stagectl midrange --scenario toroid --out new/run": ("stagectl", ()),
    "calibrate milling --out found.h5": ("calibration", (*TRIALS, *LONG)),
    "calibrate joints --joints 1 --out found.h5": ("calibration", ()),
    "calibrate velocity --out found.h5": ("calibration", ()),
    "calibrate velocity --again --out velocity.h5": ("calibration", ()),
}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a folder with the models that the commands want."""
    made = tmp_path_factory.mktemp("models")
    linear_model(made)
    write_models(made)
    write_milling(made / "milling.h5", models(), {})
    write_model(made / "velocity.h5", nominal_velocity(250.0))
    return made


@pytest.mark.sample(1)
@pytest.mark.parametrize("command", COMMANDS)
def test_what_the_disk_has_no_room_for_is_refused_in_one_line_and_leaves_nothing(
    command: str, place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    package, settings = COMMANDS[command]
    monkeypatch.setattr(Line, "__enter__", lambda _: pytest.fail("the line was opened"))
    monkeypatch.chdir(place)
    before = sorted(place.rglob("*"))
    leave(67.11e6, monkeypatch)
    given = [word for setting in settings for word in ("--set", setting)]
    monkeypatch.setattr("sys.argv", [*command.split(), *given])
    assert importlib.import_module(f"{package}.__main__").main() == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith("error: ")
    assert "67.11 MB are free and 67.11 MB of it stay so" in error
    assert sorted(place.rglob("*")) == before
