"""A mid-ranging run in its folder: recorded, measured, reported; what a fault or a stop leaves is kept as well."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ctlblocks import Block, recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit import config as rig_file
from rigkit.disk_space import require
from rigkit.kept_files import kept_files
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from rigkit.run_origin import keep_origin
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.axes import Runs, all_figures
from stagectl.robot.midranging.live import LiveFault
from stagectl.robot.midranging.report import write_report
from stagectl.robot.midranging.scenario import Scenario
from stagectl.robot.midranging.wiring import MEASURED

KIND = "mid-ranging run"


def create(path: Path, cell: CellConfig) -> RunFolder:
    """Make the folder of a new run; ValueError where something is in it already."""
    files = kept_files(cell, ["learning.model"])
    with RunFolder.filled(path, rig_file.dump(files.config), "`export` takes its recordings") as folder:
        keep_origin(folder, KIND, files.config, files.take_into(folder), [])
    return folder


def recording_name(axis: str) -> str:
    """Return how the recording of an axis is called in a run's folder."""
    return f"recording-{axis}.csv" if axis else "recording.csv"


def require_room(path: Path, made: Block, chosen: dict[str, Scenario]) -> None:
    """Refuse, by a `DiskFault`, a run that the disk has no room for.

    Parameters
    ----------
    path : Path
        Folder of the run; need not exist.
    made : Block
        The controller of one axis.
    chosen : dict of str to Scenario
        By axis.
    """
    channels = 1 + len(MEASURED) + len(made.outputs)
    needed = sum(bytes_of(len(each.reference), channels, "float64", "csv") for each in chosen.values())
    require(path, needed, "the recordings")


def about(controller: str, scenario: str) -> dict[str, str]:
    """Return the provenance of a run's recordings."""
    return {"controller": controller, "scenario": scenario, "time": now(), "software": software()}


def recorded(folder: RunFolder, run: Callable[[], Runs], chosen: dict[str, Scenario], kept: dict[str, str]) -> Runs:
    """Run it; of a live run that a fault ends, what was recorded until then is kept as well.

    Parameters
    ----------
    folder : RunFolder
    run : callable() -> Runs
    chosen : dict of str to Scenario
        By axis.
    kept : dict of str to str
        Provenance of the recordings.
    """
    try:
        return run()
    except LiveFault as fault:
        if not fault.recorded:
            raise
        write(folder, dict(zip(chosen, fault.recorded, strict=False)), kept | {"fault": str(fault)})
        folder.event("fault", {"text": str(fault)})
        raise


def keep(
    folder: RunFolder,
    runs: Runs,
    chosen: dict[str, Scenario],
    cell: CellConfig,
    kept: dict[str, str],
    png: Path | None = None,
) -> dict[str, Any]:
    """Write recordings, figures and report of a run into its folder; return the figures."""
    whole = write(folder, runs, kept)
    found = all_figures(whole, chosen, cell.midranging)
    folder.summarise(found)
    write_report(folder.path, whole, chosen, cell.midranging, found, png)
    return found


def write(folder: RunFolder, runs: Runs, kept: dict[str, str]) -> Runs:
    """Write the recordings of a run into its folder, and return them with their provenance."""
    whole = {axis: Recording(each.names, each.units, each.rate, each.data, kept) for axis, each in runs.items()}
    for axis, each in whole.items():
        recording.write(folder.path / recording_name(axis), each)
    return whole
