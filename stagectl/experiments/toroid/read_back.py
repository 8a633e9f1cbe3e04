"""Runs of the cell in their folder: what they are made from, kept there and read back."""

import tomllib
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

from rigkit import config as rig_file
from rigkit.experiment.kind import Kind, Records
from rigkit.kept_files import kept_files
from rigkit.origin import RUN, read_origin
from rigkit.run_folder import CONFIG, RunFolder, read_events
from stagectl.config import StageConfig
from stagectl.devices.signals import AXES
from stagectl.experiments.piezo.run_setup import model_name
from stagectl.experiments.toroid.event_text import reasons_of, setup_of
from stagectl.experiments.toroid.experiment import Confirm, Toroid
from stagectl.experiments.toroid.makes import refuse_wrong_plants
from stagectl.experiments.toroid.plan import ALL, RATE, SETUPS, Plan, loops_of, plan, refuse_count
from stagectl.link.config import GONE
from stagectl.models.model_file import read_model
from stagectl.models.model_origin import refuse_foreign
from stagectl.robot.config import CellConfig
from stagectl.stage.loop_parameters import loops_from_json

STAGE = "stage.toml"


@dataclass(frozen=True)
class Files:
    """What a run is made from, beside the cell's own file.

    Parameters
    ----------
    stage : StageConfig
    models : sequence of Path
        Of the stage, one an axis, or none.
    """

    stage: StageConfig
    models: Sequence[Path] = ()

    def refuse_foreign(self, accept: Collection[str]) -> list[str]:
        """Refuse models of another stage, or of one that was wired otherwise; return what is to be said.

        Parameters
        ----------
        accept : collection of str
            Keys of the stage's rig file that may differ.

        Raises
        ------
        ValueError : another number of models, or one of another axis.
        DisagreementError : the stage was wired otherwise.
        """
        refuse_count(self.models)
        models = [read_model(file, rate=RATE) for file in self.models]
        return refuse_foreign(self.stage, self.models, models, accept)

    def take_into(self, folder: RunFolder) -> list[str]:
        """Copy them into the folder of a run; return their names there."""
        stage = kept_files(self.stage, ["reference.signal"], "stage-files")
        folder.write(STAGE, rig_file.dump(stage.config))
        names = [STAGE, *stage.take_into(folder)]
        for axis, model in zip(AXES, self.models, strict=bool(self.models)):
            folder.take_in(model, model_name(axis))
            names.append(model_name(axis))
        return names


def plans_of(setup: str, cell: CellConfig, files: Files, is_live: bool = False) -> list[Plan]:
    """Return a setup's plan, or those of all.

    Raises
    ------
    ValueError : another setup, models or options of plants that do not fit, or a path that the robot does not reach.
    """
    setups = list(SETUPS) if setup == ALL else [setup]
    has_stage = any(each.startswith("C") for each in setups)
    if is_live and files.models:
        raise ValueError("--model goes with a simulated stage: with --live its processor has its own loops")
    loops = loops_of(files.stage, files.models) if has_stage and not is_live else []
    plans = [plan(each, cell, files.stage, loops, is_live) for each in setups]
    for made in plans:
        refuse_wrong_plants(made)
    return plans


def read_back(path: Path, records: Records, settings: Sequence[str] = ()) -> Toroid:  # noqa: ARG001 (a reader's)
    """Return the setups of a folder that were begun.

    Parameters
    ----------
    path : Path
    records : mapping of str to Recording
    settings : sequence of str
        Laid over the cell's rig file.

    Raises
    ------
    ValueError : it is no folder of theirs.
    """
    _refuse_other(path)
    events = [event for event in read_events(path) if event["event"] in ("started", "ended")]
    begun = {setup_of(event) for event in events}
    reasons = dict.fromkeys(begun, "killed, or not yet at its end") | reasons_of(events)
    setups = [setup for setup in SETUPS if setup in begun]
    if not setups:
        raise ValueError(f"{path}: nothing is recorded")
    return Toroid(_plans(path, setups, settings), reasons)


def left_of(path: Path, done: Collection[str], confirm: Confirm) -> Toroid:
    """Return the setups of a run that have not come to their end.

    Parameters
    ----------
    path : Path
        Of its folder.
    done : collection of str
        Setups that have.
    confirm : callable(what, stopped)
        As of `Toroid`.

    Raises
    ------
    ValueError : it is no folder of theirs, or all have come to their end.
    """
    _refuse_other(path)
    origin = read_origin(path / RUN)
    asked = origin.designed.get("setups", ()) if origin else ()
    left = [setup for setup in asked if setup not in done]
    if not left:
        raise ValueError(f"{path}: nothing is left of it: {', '.join(asked) or 'no setup'} came to the end")
    return Toroid(_plans(path, left), confirm=confirm)


def was_live(path: Path) -> bool:
    """Return whether a run's robot was behind its wires."""
    origin = read_origin(path / RUN)
    return bool(origin and origin.designed.get("live"))


def setup_of_track(track: str) -> str:
    """Return the setup that a recording is of."""
    return track.rpartition("-")[0]


def _refuse_other(path: Path) -> None:
    if not (path / STAGE).is_file():
        raise ValueError(f"{path}/ is not the folder of a run of the cell: it has no {CONFIG} and {STAGE}")


def _not_known(path: Path) -> list[str]:
    """Return settings that switch off what the program of a run's folder did not do yet."""
    feedback = tomllib.loads((path / CONFIG).read_text(encoding="utf-8")).get("feedback", {})
    return [] if "orientation" in feedback else ["feedback.orientation=0"]


def _plans(path: Path, setups: Sequence[str], settings: Sequence[str] = ()) -> list[Plan]:
    """Return setups as a run's folder has them, with the stage's loops that were used."""
    settings = [*_not_known(path), *settings]
    cell = rig_file.load(path / CONFIG, CellConfig, settings)
    stage = rig_file.load(path / STAGE, StageConfig, gone=GONE)
    origin = read_origin(path / RUN)
    told = origin.designed.get("loops", {}) if origin else {}
    is_live = was_live(path)
    if is_live:
        loops = []
    elif told:
        loops = loops_from_json(AXES, told, RATE)
    elif any(setup.startswith("C") for setup in setups):  # version 0.1.0 kept the models alone
        models = [path / model_name(axis) for axis in AXES]
        loops = loops_of(stage, models if models[0].exists() else ())
    else:
        loops = []
    return [plan(setup, cell, stage, loops, is_live) for setup in setups]


TOROID = Kind("cell runs", read_back, apart=("learning.model",), is_older=lambda path: (path / STAGE).is_file())
