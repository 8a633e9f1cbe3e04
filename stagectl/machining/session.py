"""Runs of the cell in their folder: everything recorded, measured and kept."""

from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit import config as rig_file
from rigkit.kept_files import kept_files
from rigkit.provenance import now, software
from rigkit.run_folder import CONFIG, RunFolder, read_events
from rigkit.run_origin import keep_origin
from stagectl.config import StageConfig
from stagectl.machining.measures import Contour, accuracy, contour
from stagectl.machining.plan import AXES, RATE, SETUPS, Plan, designs_of, plan, refuse_count
from stagectl.machining.recorded import EVERY, QUICK, recordings
from stagectl.machining.run import Conduct, mill
from stagectl.machining.surroundings import simulated
from stagectl.model_file import read_model
from stagectl.model_origin import refuse_foreign
from stagectl.robot.config import CellConfig
from stagectl.session import model_name

STAGE = "stage.toml"
SUFFIXES = {"cell": "csv", "surface": "csv", "tracker": "wav", "stage": "wav"}
"""Formats: of many channels a WAV is smaller and quicker; both keep every bit."""

BEFORE = 0.25
"""s before a hold that are not measured: a stage that is at fault goes to rest while the robot still moves."""


@dataclass(frozen=True)
class Files:
    """What a run is made from.

    Parameters
    ----------
    cell : CellConfig
    stage : StageConfig
    models : sequence of Path
        Of the stage, one an axis, or none.
    """

    cell: CellConfig
    stage: StageConfig
    models: Sequence[Path] = ()


def refuse_foreign_models(files: Files, accept: Collection[str]) -> list[str]:
    """Refuse models of another stage, or of one that was wired otherwise; return what is to be said.

    Parameters
    ----------
    files : Files
    accept : collection of str
        Keys of the stage's rig file that may differ.

    Raises
    ------
    ValueError : another number of models, or one of another axis.
    DisagreementError : the stage was wired otherwise.
    """
    refuse_count(files.models)
    models = [read_model(file, rate=RATE) for file in files.models]
    return refuse_foreign(files.stage, files.models, models, accept)


def create(path: Path, files: Files, accept: Collection[str] = ()) -> RunFolder:
    """Make the folder of new runs, with copies of all files; ValueError where something is in it already."""
    cell = kept_files(files.cell, ["learning.model"])
    stage = kept_files(files.stage, ["reference.signal"], "stage-files")
    with RunFolder.filled(path, rig_file.dump(cell.config)) as folder:
        folder.write(STAGE, rig_file.dump(stage.config))
        parts = [STAGE, *cell.take_into(folder), *stage.take_into(folder)]
        for axis, model in zip(AXES, files.models, strict=bool(files.models)):
            folder.take_in(model, model_name(axis))
            parts.append(model_name(axis))
        keep_origin(folder, "cell runs", cell.config, parts, sorted(accept))
    return folder


def room(made: Plan) -> int:
    """Return the bytes that the recordings of a setup may take."""
    return sum(
        bytes_of(
            round(made.path.seconds * RATE / EVERY[name]),
            sum(signal.width for signal in signals),
            "float64",
            SUFFIXES[name],
        )
        for name, signals in recordings(made).items()
    )


def is_of_cell(path: Path) -> bool:
    """Whether a folder is one of runs of the cell."""
    return (path / CONFIG).is_file() and (path / STAGE).is_file()


def files_of(path: Path) -> Files:
    """Read back what runs were made from; ValueError if the folder is none of theirs."""
    if not is_of_cell(path):
        raise ValueError(f"{path}/ is not the folder of a run of the cell: it has no {CONFIG} and {STAGE}")
    models = [path / model_name(axis) for axis in AXES]
    return Files(
        rig_file.load(path / CONFIG, CellConfig),
        rig_file.load(path / STAGE, StageConfig),
        models if models[0].exists() else (),
    )


def run(folder: RunFolder, made: Plan, conduct: Conduct) -> dict[str, Any]:
    """Run a setup, and return its figures.

    Parameters
    ----------
    folder : RunFolder
    made : Plan
    conduct : Conduct
    """
    about = {"rig": made.stage.rig.name, "setup": made.setup, "date": now(), "software": software()}
    folder.event("started", {"setup": made.setup, "software": software()})
    done = mill(made, conduct, simulated, recordings(made), about)
    for name, kept in done.recordings.items():
        recording.write(folder.path / f"{made.setup}-{name}.{SUFFIXES[name]}", kept)
    ticks = len(done.recordings["surface"].data) * QUICK
    folder.event("ended", {"setup": made.setup, "seconds": ticks / RATE, "reason": done.reason, **done.figures})
    return figures(made, done.recordings, done.reason)


def figures(made: Plan, records: dict[str, Recording], reason: str) -> dict[str, Any]:
    """Return what a run comes to, other programs' keys.

    Parameters
    ----------
    made : Plan
    records : dict of str to Recording
        `cell` and `surface`.
    reason : str

    Returns
    -------
    dict
        `setup`, `what`, `seconds`, `fault` (or null); where something was milled `circle_mae`, `circle_std`,
        `circle_max`, `surface_std`, `roughness` (m); with a stage, by axis, `travel` (lowest and highest reference
        wished for, m, from the middle), `travel_limit` (m) and `seconds_at_end` (s).
    """
    found: dict[str, Any] = {
        "setup": made.setup,
        "what": SETUPS[made.setup],
        "seconds": len(records["surface"].data) * QUICK / RATE,
        "fault": reason or None,
    }
    milled = milled_contour(made, records)
    if milled is not None:
        found |= asdict(accuracy(milled))
    if made.has_stage:
        wished = records["cell"].select([f"fast_reference_{axis}" for axis in AXES])
        low, high = made.stage.limits.travel
        limit = (high - low) / 2
        found["travel"] = {axis: [float(w.min()), float(w.max())] for axis, w in zip(AXES, wished.data.T, strict=True)}
        found["travel_limit"] = limit
        found["seconds_at_end"] = float((abs(wished.data) > limit).any(axis=1).sum() / wished.rate)
    return found


def milled_contour(made: Plan, records: dict[str, Recording]) -> Contour | None:
    """Return the toroid as it was milled, until just before a hold, or None where nothing was.

    Parameters
    ----------
    made : Plan
    records : dict of str to Recording
        `cell` and `surface`.
    """
    surface, cell = records["surface"], records["cell"]
    begin = round(made.cell.toroid.lead * surface.rate)
    held = np.flatnonzero(cell.select(["holding"]).data[round(made.cell.toroid.lead * cell.rate) + 2 :, 0])
    until = len(surface.data)
    if len(held):
        until = begin + round((held[0] / cell.rate - BEFORE) * surface.rate)
    cut = surface.select([f"cut_{axis}" for axis in AXES]).data[begin:until]
    try:
        return contour(cut, made.cell.toroid.radius)
    except (ValueError, IndexError):
        return None


def read_back(path: Path) -> dict[str, tuple[Plan, dict[str, Recording], str]]:
    """Return plan, recordings and reason of every setup that a folder has, by setup.

    Raises
    ------
    ValueError : nothing is recorded.
    """
    files = files_of(path)
    reasons = {each["setup"]: each["reason"] for each in read_events(path) if each["event"] == "ended"}
    designs = designs_of(files.stage, files.models) if any(setup.startswith("C") for setup in reasons) else []
    found = {}
    for setup in SETUPS:
        if setup in reasons:
            made = plan(setup, files.cell, files.stage, designs)
            names = [name for name in SUFFIXES if (path / f"{setup}-{name}.{SUFFIXES[name]}").exists()]
            kept = {name: recording.read(path / f"{setup}-{name}.{SUFFIXES[name]}") for name in names}
            found[setup] = made, kept, reasons[setup]
    if not found:
        raise ValueError(f"{path}: nothing is recorded")
    return found
