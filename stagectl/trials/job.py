"""All trials of a run in its folder, simulated or on the robot: learned from, kept, reported and told of."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from rigkit.command import print_table
from rigkit.disk_space import require
from rigkit.run_folder import RunFolder
from rigkit.stop import stoppable
from stagectl.robot.live.person import Person
from stagectl.trials.campaign import FIRST, Learner, learn_free_space, learn_pocket
from stagectl.trials.conduct import Conduct
from stagectl.trials.done import DoneTrial
from stagectl.trials.live import performing
from stagectl.trials.log_folder import write_logs
from stagectl.trials.report import HEAD, TABLE_HEAD, figures, method_rows, trial_report, trial_rows
from stagectl.trials.session import PACES, Runner, create, grouped, is_recorded, read_back, room
from stagectl.trials.trial import Trial
from stagectl.wire.egm import RATE

PAGE, LOGS = "report.html", "logs"


@dataclass(frozen=True)
class Job:
    """What is run, and how.

    Parameters
    ----------
    task : str
    model : Path
        File of the models that it learns by.
    first : Trial
    methods : tuple of int
    iterations : int
        Trials in material after the first one, of each method.
    is_live, is_sure : bool
        On the robot; without asking before each trial.
    accept : tuple of str
        Keys in which the cell that the models were measured on may differ.
    """

    task: str
    model: Path
    first: Trial
    methods: tuple[int, ...]
    iterations: int
    is_live: bool = False
    is_sure: bool = False
    accept: tuple[str, ...] = ()


def run_trials(out: Path, job: Job, learner: Learner, png: Path | None, stream: TextIO) -> dict[str, Any]:
    """Run all trials of all methods; return the figures.

    Parameters
    ----------
    out : Path
        Folder to make; taken away where no trial was recorded.
    job : Job
    learner : Learner
    png : Path or None
        Folder for the figures as PNG files as well.
    stream : text stream

    Raises
    ------
    ValueError : a trial that a fault has ended, or that is refused; what was recorded is kept.
    OSError : a wire of a live robot.
    Stopped : it was asked to, between trials.
    """

    def tell(text: str) -> None:
        print(text, file=stream, flush=True)  # noqa: T201

    trials = learner.cell.learning.free + 1 + job.iterations * len(job.methods)
    require(out, room(job.first, trials), f"{trials} trials")
    with create(out, learner.cell, job.task, job.model, job.accept) as folder, stoppable() as stop:
        conduct = Conduct(folder.event, lambda: stop.made)
        person = Person(tell, conduct.stopped, not job.is_sure) if job.is_live else None
        seconds = job.first.path.samples / RATE
        tell(f"{trials} trials of {seconds:.0f} s each, {PACES[job.is_live]}")
        try:
            with performing(learner.cell, person, conduct) as perform:
                learned = _learn(job, learner, _kept(folder, Runner(folder, conduct, perform, tell)))
        finally:
            if is_recorded(folder.path):
                found = report_again(folder.path, png)
                folder.summarise(found)
            else:
                folder.withdraw()
    print_table(f"{out}: errors of every trial", HEAD, trial_rows(learner.free, learned), stream)
    print_table(f"{out}: as Table 5.1", TABLE_HEAD, method_rows(learned), stream)
    tell(f"report: {out / PAGE}")
    return found


def report_again(path: Path, png: Path | None = None) -> dict[str, Any]:
    """Draw the report of a folder of trials again, and return its figures.

    Parameters
    ----------
    path : Path
    png : Path, optional
        Folder for the figures as PNG files as well.
    """
    free, learned = grouped(read_back(path))
    report = trial_report(free, learned, path)
    report.write(path / PAGE)
    if png is not None:
        report.png(png)
    return figures(free, learned)


def _kept(folder: RunFolder, runner: Runner) -> Callable[[str, Trial], DoneTrial]:
    """Return what runs a trial, and writes its logs as other robots' are read."""

    def run(name: str, trial: Trial) -> DoneTrial:
        done = runner(name, trial)
        write_logs(folder.path / LOGS / name, done)
        return done

    return run


def _learn(job: Job, learner: Learner, run: Callable[[str, Trial], DoneTrial]) -> dict[int, list[DoneTrial]]:
    milled = run(FIRST, learn_free_space(job.first, learner, run))
    return {each: learn_pocket(milled, learner, each, job.iterations, run) for each in job.methods}
