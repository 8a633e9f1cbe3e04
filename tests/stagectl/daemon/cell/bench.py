"""A robot cell under the daemon's authority, without processes; its trials take seconds of simulated time."""

from pathlib import Path

from rigkit import config as rig_file
from stagectl.daemon.cell.rig import RobotCell
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import write_milling
from tests.stagectl.daemon.bench import Lab, lab_of
from tests.stagectl.experiments.trials.short_trial import SMALL
from tests.stagectl.robot.milling.test_milling_models import models

QUICK = (*SMALL, "pocket.feed=25e-3", "learning.free=1")


def cell_in(folder: Path, *settings: str) -> Lab:
    """Return a cell in a folder, with models of milling that are near enough."""
    data, file = folder / "data", folder / "cell.toml"
    (data / "runs").mkdir(parents=True)
    write_milling(data / "milling.h5", models(), {})
    edit(file, data, *settings)
    return lab_of(RobotCell(lambda: rig_file.load(file, CellConfig)), file, data)


def edit(file: Path, data: Path, *settings: str) -> None:
    """Write the cell's file anew."""
    file.write_text(rig_file.dump(rig_file.load(None, CellConfig, [*QUICK, f"daemon.data={data}", *settings])))
