"""Runs of trials in their folder: what they are made from, kept there and read back."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rigkit import config as rig_file
from rigkit.experiment.kept import told
from rigkit.experiment.kind import Kind, Records
from rigkit.experiment.runner import KILLED
from rigkit.origin import RUN, read_origin
from rigkit.run_folder import CONFIG, RunFolder, read_events
from stagectl.experiments.trials.experiment import REFUSED, Milling
from stagectl.experiments.trials.runner import trial_of
from stagectl.experiments.trials.trial import cell_for_task, first_trial
from stagectl.robot.config import CellConfig

TASK = "task.txt"
"""File of a run's folder that has the name of its task."""
MODEL, JOINTS = "milling.h5", "joints.h5"
"""And its copies of the models, and of the joints'."""
ENDED = "-ended"
"""How the name of a trial ends that ended early, in folders of version 0.1.0."""


@dataclass(frozen=True)
class Files:
    """What trials are made from beside the cell's rig file.

    Parameters
    ----------
    task : str
    model : Path
        File of the models that are learned by.
    joints : Path, optional
        Of the joints' models, whose lost motion the path carries.
    """

    task: str
    model: Path
    joints: Path | None = None

    def take_into(self, folder: RunFolder) -> list[str]:
        """Copy them into the folder of a run; return their names there."""
        folder.write(TASK, f"{self.task}\n")
        folder.take_in(self.model, MODEL)
        if self.joints is None:
            return [TASK, MODEL]
        folder.take_in(self.joints, JOINTS)
        return [TASK, MODEL, JOINTS]


def is_of_trials(path: Path) -> bool:
    """Whether a folder is one of trials that were learned from."""
    return (path / CONFIG).is_file() and (path / TASK).is_file()


def task_of(path: Path) -> tuple[CellConfig, str]:
    """Return the cell of a folder of trials, and its task; ValueError if it is none of theirs."""
    if not is_of_trials(path):
        raise ValueError(f"{path}/ is not the folder of trials: it has no {CONFIG} and {TASK}")
    task = (path / TASK).read_text(encoding="utf-8").strip()
    return cell_for_task(rig_file.load(path / CONFIG, CellConfig), task), task


def read_back(path: Path, records: Records, settings: Sequence[str] = ()) -> Milling:  # noqa: ARG001 (a reader's)
    """Return the trials of a folder, for report and replay.

    Parameters
    ----------
    path : Path
    records : mapping of str to Recording
    settings : sequence of str
        None: another path would have been another cut.

    Raises
    ------
    ValueError : it is no folder of theirs.
    """
    first = first_trial(*task_of(path))
    reasons = dict.fromkeys(told(path, "started"), KILLED)
    reasons |= {part: end["reason"] for part, end in told(path, "ended").items()}
    reasons |= {name: "ended early" for name in map(trial_of, records) if name.endswith(ENDED)}
    return Milling(first, reasons=reasons, refused=_refused(path))


def _refused(path: Path) -> dict[str, str]:
    """Return why methods were refused, by number, but of those that were learned by later."""
    found: dict[str, str] = {}
    for event in read_events(path):
        if event["event"] == REFUSED:
            found[str(event["method"])] = event["text"]
        elif event["event"] == "started" and (of := re.match(r"method-(\d)-", event.get("part", ""))):
            found.pop(of[1], None)
    return found


def asked_of(path: Path) -> tuple[tuple[int, ...], int]:
    """Return the methods and iterations that a run was begun with."""
    origin = read_origin(path / RUN)
    told = origin.designed if origin else {}
    return tuple(told.get("methods", (1,))), int(told.get("iterations", 0))


def was_live(path: Path) -> bool:
    """Return whether a run's robot was behind its wires."""
    origin = read_origin(path / RUN)
    return bool(origin and origin.designed.get("live"))


TRIALS = Kind("milling trials", read_back, apart=("learning.model",), what_if=False, is_older=is_of_trials)
