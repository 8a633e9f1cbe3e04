"""Trials in a folder: each is run, recorded, kept and told of; read back for report and replay."""

import re
from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path

from ctlblocks.room import bytes_of
from rigkit import config as rig_file
from rigkit.kept_files import kept_files
from rigkit.provenance import now, software
from rigkit.run_folder import CONFIG, RunFolder
from rigkit.run_origin import keep_origin
from rigkit.stop import Stopped
from stagectl.robot.config import CellConfig
from stagectl.trials.campaign import FIRST, FREE
from stagectl.trials.conduct import Conduct, Milled
from stagectl.trials.done import SUFFIXES, WHOLE, DoneTrial, TrialEnded, has_trial, read_trial
from stagectl.trials.recorded import EVERY, RECORDED, SLOW
from stagectl.trials.run import run
from stagectl.trials.surroundings import simulated
from stagectl.trials.trial import Trial, first_trial

PACES = {True: "in real time", False: "simulated some five times as fast"}
"""How long motions take, live and simulated."""
LEARNING = "task.txt"
"""File of a run's folder that has the name of its task."""
MODEL = "milling.h5"
"""And its copy of the models."""
Tell = Callable[[str], None]
Perform = Callable[[Trial, Conduct], Milled]
"""Runs a trial: `run_simulated`, or `live.LiveTrials`."""


def run_simulated(trial: Trial, conduct: Conduct) -> Milled:
    """Run a trial on the simulated cell."""
    about = {"trial": str(trial.number), "date": now(), "software": software()}
    return run(trial, conduct, simulated, RECORDED, about)


def create(path: Path, cell: CellConfig, task: str, model: Path, accept: Collection[str] = ()) -> RunFolder:
    """Make the folder of new trials, with a copy of the models; ValueError where something is in it already."""
    files = kept_files(cell, ["learning.model"])
    with RunFolder.filled(path, rig_file.dump(files.config)) as folder:
        folder.write(LEARNING, f"{task}\n")
        folder.take_in(model, MODEL)
        keep_origin(folder, "milling trials", files.config, [LEARNING, MODEL, *files.take_into(folder)], sorted(accept))
    return folder


class Runner:
    """Runs trials into a folder; one that is there already is read.

    Parameters
    ----------
    folder : RunFolder
    conduct : Conduct
    perform : Perform
    tell : callable(str)
        Told a line of each trial.
    """

    def __init__(self, folder: RunFolder, conduct: Conduct, perform: Perform, tell: Tell) -> None:
        self.folder, self._conduct, self._perform, self._tell = folder, conduct, perform, tell

    def __call__(self, name: str, trial: Trial) -> DoneTrial:
        """Run a trial, and keep it.

        Raises
        ------
        Stopped, TrialEnded : a person, or a fault, ended it; what was recorded until then is kept.
        OSError : a live robot that did not come to its beginning.
        """
        path = self.folder.path
        if has_trial(path, name):
            return read_trial(path, name, trial)
        self.folder.event("started", {"trial": name, "milled": trial.is_milled})
        try:
            came = self._perform(trial, self._conduct)
        except OSError as fault:
            self.folder.event("ended", {"trial": name, "reason": str(fault)})
            raise
        done = DoneTrial(name if not came.reason else f"{name}-ended", trial, came.recordings)
        done.write(path)
        self.folder.event("ended", {"trial": name, "reason": came.reason, **came.figures})
        if came.reason:
            text = f"{name}: {came.reason}; what is recorded is in {path}/"
            raise Stopped(text) if self._conduct.stopped() else TrialEnded(text)
        if trial.zero is not None and trial.path.milled.any():
            size = 1e6 * done.mae
            self._tell(f"{name}: MAE x {size[0]:.0f}, y {size[1]:.0f}, z {size[2]:.0f} µm")
        return done


def room(first: Trial, trials: int) -> int:
    """Return the bytes that so many trials of a path may take, with logs that are as long again.

    Parameters
    ----------
    first : Trial
    trials : int
    """
    ticks = first.path.samples * SLOW
    one = sum(
        bytes_of(ticks // EVERY[name], sum(signal.width for signal in signals), "float64", SUFFIXES[name])
        for name, signals in RECORDED.items()
    )
    return 2 * one * trials


def is_of_trials(path: Path) -> bool:
    """Whether a folder is one of trials that were learned from."""
    return (path / CONFIG).is_file() and (path / LEARNING).is_file()


def is_recorded(path: Path) -> bool:
    """Whether a folder has a trial."""
    return any(path.glob(f"*{WHOLE}"))


def read_back(path: Path) -> list[DoneTrial]:
    """Return all trials of a folder, in the order of their numbers; ValueError if it is none of theirs, or empty."""
    if not is_of_trials(path):
        raise ValueError(f"{path}/ is not the folder of trials: it has no {CONFIG} and {LEARNING}")
    task = (path / LEARNING).read_text(encoding="utf-8").strip()
    first = first_trial(rig_file.load(path / CONFIG, CellConfig), task)
    if not is_recorded(path):
        raise ValueError(f"{path}: nothing is recorded")
    names = [file.name.removesuffix(WHOLE) for file in path.glob(f"*{WHOLE}")]
    return sorted((read_trial(path, name, first) for name in names), key=lambda each: each.trial.number)


def grouped(trials: list[DoneTrial]) -> tuple[list[DoneTrial], dict[int, list[DoneTrial]]]:
    """Return trials in the air, and those of each method with iteration 0 first; those that a fault ended are left out.

    Parameters
    ----------
    trials : list of DoneTrial
        As `read_back` gives them.
    """
    free = [each for each in trials if re.fullmatch(rf"{FREE}-\d+", each.name)]
    first = [each for each in trials if each.name == FIRST]
    learned: dict[int, list[DoneTrial]] = {}
    for each in trials:
        if found := re.fullmatch(r"method-(\d)-\d+", each.name):
            learned.setdefault(int(found[1]), list(first)).append(each)
    if free and free[-1].trial.zero is not None:  # the first was run before it was known where the tracker has the work
        last = free[-1].trial
        free[0] = replace(free[0], trial=replace(free[0].trial, zero=last.zero, block=last.block, late=last.late))
    return free, learned
