"""Rows of a week in the lab: runs of the stage and of the robot's cell, each made once before the week begins."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

from calibration.__main__ import main as calibrate
from calibration.milling.session import SIMULATED
from rigkit import config as rig_file
from stagectl.__main__ import main as stagectl
from stagectl.config import StageConfig
from stagectl.experiments.trials.trial import cell_for_task
from stagectl.models.model_file import write_model
from stagectl.planning.example_pocket import EXAMPLE_POCKET
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import write_milling
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.wire.robot import RATE
from tests.scenario.lab import (
    Cell,
    Lab,
    as_another,
    beside,
    left,
    moved,
    repeated,
    same_bits,
    stopped_then_rewired,
    unfinished,
)
from tests.stagectl.daemon.cell.bench import QUICK as TRIALS
from tests.stagectl.experiments.feed.small_pocket import QUICK as POCKET
from tests.stagectl.experiments.piezo.simulated_models import simulated_model
from tests.stagectl.experiments.piezo.test_session import QUICK
from tests.stagectl.experiments.toroid.short_cell import SHORT
from tests.stagectl.robot.milling.test_milling_models import models

TASK = "pocket"
MODELS = ("--model", "x.h5", "--model", "y.h5", "--model", "z.h5")
STAGE = ("run", "--config", "quick.toml", *MODELS)
ILC = ("ilc", "--config", "mill.toml", "--task", TASK, "--model", "milling.h5", "--iterations", "1")
CELL = ("cell", "--config", "mill.toml", "--setup", "B", "--stage", "quick.toml", *MODELS)
FORCE = ("force", "--config", "mill.toml", "--task", "slot", "--model", "feed.h5")
MIDRANGE = ("midrange", "--config", "mill.toml", "--scenario", "thesis-1")
PLAN = ("plan", "POCKET.json", "--out", "PATH.json")
MILLING = ("milling", "--config", "slow.toml", "--task", TASK, "--out", "mill.h5")
RUNS = {"STAGE": STAGE, "ILC": ILC, "CELL": CELL, "FORCE": FORCE, "MIDRANGE": MIDRANGE}
SECOND = "simulator.options.seed=9"


def add_runs(lab: Lab) -> None:
    """Make models, those of other machines too, and each run."""
    for name, model, overrides in (
        ("quick.toml", StageConfig, (*QUICK, "session.seconds=0.2", "simulator.options.seed=1")),
        ("mill.toml", CellConfig, (*TRIALS, *POCKET, *SHORT, "segments.travel=0.15")),
        ("slow.toml", CellConfig, (*TRIALS, "pocket.feed=6e-3")),
    ):
        (lab.path / name).write_text(rig_file.dump(rig_file.load(None, model, overrides)))
    for folder, second in ((lab.path, ()), (lab.path / "others", (SECOND,))):
        folder.mkdir(exist_ok=True)
        _write_models(lab.path, folder, second)
    pocket = json.loads(EXAMPLE_POCKET) | {"rows": 6, "cols": 12}
    (lab.path / "POCKET.json").write_text(json.dumps(pocket))
    slow = rig_file.load(lab.path / "slow.toml", CellConfig)
    left(lab.path / "mill.h5", f"calibration of milling, {SIMULATED}", cell_for_task(slow, TASK))
    for run, words in RUNS.items():
        assert lab.call(stagectl, *words, "--out", run)[0] == 0


def _write_models(lab: Path, folder: Path, second: tuple[str, ...]) -> None:
    """Write models that say that they were measured on the machines of the rig files, with others laid over them."""
    text = rig_file.dump(rig_file.load(lab / "quick.toml", StageConfig, second))
    for axis in "xyz":
        model = replace(simulated_model(axis), output_names=(f"position_{axis}",), provenance={"config": text})
        write_model(folder / f"{axis}.h5", model)
    text = rig_file.dump(rig_file.load(lab / "mill.toml", CellConfig, second))
    write_model(folder / "feed.h5", replace(nominal_velocity(RATE), provenance={"config": text}))
    write_milling(folder / "milling.h5", replace(models(), provenance={"config": text}), {})


def rewired(lab: Lab, file: str, edit: str, *words: str) -> tuple[int, str]:
    """Edit the rig's wiring, then make a new run."""
    lab.edit(file, StageConfig if file == "quick.toml" else CellConfig, edit)
    return lab.call(stagectl, *words, "--out", "NEW")


def other_models(lab: Lab, *words: str) -> tuple[int, str]:
    """Put other machines' models in the place of these ones', then make a new run."""
    shutil.copytree(lab.path / "others", lab.path, dirs_exist_ok=True)
    return lab.call(stagectl, *words, "--out", "NEW")


def edited_pocket(lab: Lab) -> tuple[int, str]:
    """Plan a pocket, and another one under the same name."""
    assert lab.call(stagectl, *PLAN)[0] == 0
    file = lab.path / "POCKET.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"rows": 8}))
    return lab.call(stagectl, *PLAN)


def as_new(run: str, edit: Cell | None = None, others: Cell | None = None) -> tuple[Cell | None, ...]:
    """Return the row of a command that makes a run."""
    words = RUNS[run]
    return (
        lambda lab: lab.call(stagectl, *words, "--out", run),
        edit,
        others,
        lambda lab: same_bits(lab, stagectl, run, *words),
        lambda lab: as_another(lab, "NEW", stagectl, *words),
    )


CELLS: dict[str, tuple[Cell | None, ...]] = {
    "`stagectl run`": as_new(
        "STAGE",
        lambda lab: rewired(lab, "quick.toml", "link.origin=2e-4", *STAGE),
        lambda lab: other_models(lab, *STAGE),
    ),
    "`stagectl midrange`": as_new("MIDRANGE"),
    "`stagectl ilc`": as_new(
        "ILC", lambda lab: rewired(lab, "mill.toml", "robot.tool=0.2", *ILC), lambda lab: other_models(lab, *ILC)
    ),
    "`stagectl cell`": as_new(
        "CELL", lambda lab: rewired(lab, "quick.toml", "link.origin=2e-4", *CELL), lambda lab: other_models(lab, *CELL)
    ),
    "`stagectl force`": as_new(
        "FORCE", lambda lab: rewired(lab, "mill.toml", "robot.tool=0.2", *FORCE), lambda lab: other_models(lab, *FORCE)
    ),
    "`stagectl plan`": (
        lambda lab: repeated(lab, stagectl, *PLAN),
        edited_pocket,
        None,
        lambda lab: moved(lab, stagectl, *PLAN),
        None,
    ),
    "`calibrate milling`": (
        lambda lab: lab.call(calibrate, *MILLING),
        lambda lab: stopped_then_rewired(lab, "mill.h5", CellConfig, "slow.toml", "robot.tool=0.2", *MILLING),
        None,
        lambda lab: moved(lab, calibrate, *MILLING),
        lambda lab: (unfinished(lab, "mill.h5"), beside(lab, "mill.raw", calibrate, *MILLING))[1],
    ),
}
"""A command's row, as in `tests.scenario.lab_week`."""
