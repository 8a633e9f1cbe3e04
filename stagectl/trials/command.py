"""The command `stagectl ilc`: a path learned in free space, then in material."""

import sys
from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, words, write_json
from stagectl.model_origin import refuse_other_wiring
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_needless_yes, refuse_unattended
from stagectl.robot.milling.milling_models import MillingModels, read_milling
from stagectl.robot.milling.torque_file import read_force_model
from stagectl.robot.milling.trial_error import METHODS, kinematic_error
from stagectl.trials.campaign import Learner, determined
from stagectl.trials.job import Job, run_trials
from stagectl.trials.joint_speeds import refuse_unknown_speeds
from stagectl.trials.live import steps
from stagectl.trials.log_folder import LogFolder, write_path
from stagectl.trials.surroundings import refuse_wrong_plants
from stagectl.trials.tool_path import RATE
from stagectl.trials.trial import TASKS, Trial, cell_for_task, first_trial

ALL, AIR, NEXT = "all", "free", "next.csv"
UNTOUCHED = "nothing is touched off, where the tracker's axes are off is learned as an error, and the cut goes by G_M"


def ilc(
    method: Annotated[str, typer.Option(metavar="METHOD", help=f"1, 2, 3, several as 1,2, or {ALL}.")] = "1",
    iterations: Annotated[int, typer.Option(help="Trials in material after the first one.", min=1, max=50)] = 4,
    task: Annotated[str, typer.Option(metavar="TASK", help=f"{', '.join(TASKS)}.")] = "pocket28",
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for trials and report.")] = None,
    is_live: Annotated[bool, typer.Option("--live", help="The robot of [robot]; else the simulated cell.")] = False,
    is_sure: Annotated[bool, typer.Option("--yes", help="Live: go on from trial to trial without asking.")] = False,
    dry: Annotated[bool, typer.Option("--dry-run", help="Print every motion of a live run, and make none.")] = False,
    logs: Annotated[
        Path | None, typer.Option("--from", metavar="LOGDIR", help="Learn from the logs of one trial; run nothing.")
    ] = None,
    config: ConfigOption = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Models; else learning.model.")] = None,
    png: PngOption = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Learn to mill a pocket: free space first, then trials in material; errors as in Table 5.1, paths, a report.

    Method 1 learns from what the tracker sees, 2 from motor angles and the force sensor, 3 from motor angles and the
    force estimated from motor torques.  With --from it reads the logs of a trial that was run elsewhere, and writes
    the path to send next into that folder.

    Live, it asks before each trial: for no block, or for a fresh one.  Ctrl-C in a trial lifts the tool out.

    Examples: `stagectl ilc --config cell.toml --method 1 --iterations 4 --task pocket28 --out RUN/`,
    `stagectl ilc --config cell.toml --method 1 --live --out RUN/`, `stagectl ilc --method 3 --from LOGDIR/`
    """
    methods = wanted_methods(method)
    if logs is not None:
        _refuse_with_logs({"--live": is_live, "--dry-run": dry, "--out": out is not None, "--png": png is not None})
    refuse_needless_yes(is_sure, is_live)
    cell = cell_for_task(rig_file.load(config, CellConfig, settings or []), task)
    first = first_trial(cell, task)
    if dry:
        _say_steps(cell, first, 1 + iterations * len(methods))
        return
    known = model or Path(cell.learning.model)
    learner = learner_of(cell, known, first, methods, accept or [], lambda text: sys.stderr.write(f"{text}\n"))
    if logs is not None:
        if len(methods) != 1:
            raise ValueError(f"--method is {method!r}, must be one with --from")
        _say_next(logs, learn_from_logs(logs, first, learner, methods[0]), json)
        return
    if out is None:
        raise ValueError("--out is missing: trials are kept there")
    job = Job(task, known, first, methods, iterations, is_live, is_sure, tuple(accept or ()))
    _refuse(job, learner)
    write_json(json, run_trials(out, job, learner, png, words(json)))


def _refuse_with_logs(given: dict[str, bool]) -> None:
    for name in (name for name, is_given in given.items() if is_given):
        raise ValueError(f"{name} and --from are given, must be one of them: nothing is run, LOGDIR gets the path")


def _say_next(logs: Path, path: Path, json: str | None) -> None:
    if not (logs / AIR).is_dir():
        print(f"{logs / AIR}/ is not there: {UNTOUCHED}", file=words(json))  # noqa: T201
    print(f"the path to send next: {path}", file=words(json))  # noqa: T201
    write_json(json, {"path": str(path)})


def _say_steps(cell: CellConfig, first: Trial, trials: int) -> None:
    for number, each in enumerate(steps(cell, first, trials), start=1):
        typer.echo(f"{number:3d}  {each}")


def _refuse(job: Job, learner: Learner) -> None:
    """Refuse what cannot be run, before anything moves or is written, by ValueError."""
    for learned in (None, *job.methods):
        learner.contraction(learned).refuse_divergence()
    if not job.is_live:
        refuse_wrong_plants(job.first)
        return
    if 3 in job.methods and not learner.cell.robot.signals:
        raise ValueError("robot.signals is 0: method 3 needs the motors' torques, must be the port of their line")
    refuse_unattended(learner.cell, job.is_sure)


def wanted_methods(text: str) -> tuple[int, ...]:
    """Read "1", "1,3" or "all"; ValueError for anything else."""
    known = {str(each): each for each in METHODS}
    found = list(known.values()) if text == ALL else [known.get(part.strip(), 0) for part in text.split(",")]
    if not all(found):
        raise ValueError(f"method is {text!r}, must be {', '.join(known)}, several of them, or {ALL}")
    return tuple(dict.fromkeys(found))


def learner_of(
    cell: CellConfig,
    file: Path,
    first: Trial,
    methods: tuple[int, ...],
    accept: Collection[str] = (),
    say: Callable[[str], object] = lambda _: None,
) -> Learner:
    """Read the models that methods need.

    Parameters
    ----------
    cell : CellConfig
    file : Path
    first : Trial
    methods : tuple of int
    accept : collection of str
        Keys in which the cell that they were measured on may differ.
    say : callable(str)
        Told what differs without harm.

    Raises
    ------
    ValueError : no such file, or one without what they need: for method 3, friction at the speeds of the path.
    DisagreementError : measured on a cell that was wired otherwise.
    """
    models: MillingModels = read_milling(file)
    for text in refuse_other_wiring(cell, file, models.provenance, accept, "cell"):
        say(text)
    if 3 not in methods:
        return Learner(cell, models)
    known = read_force_model(file, first.arm, cell.force_estimate)
    refuse_unknown_speeds(first, known.friction.speed[-1], known.friction.smoothing, str(file))
    return Learner(cell, models, lambda angle, torque: known.estimate(angle, torque, RATE).force)


def learn_from_logs(folder: Path, first: Trial, learner: Learner, method: int) -> Path:
    """Learn from the logs of one trial; write the path to send next into their folder, and return where.

    Parameters
    ----------
    folder : Path
        Logs of a trial in material; methods 2 and 3 need those of one in the air in its folder `free`, too.
    first : Trial
    learner : Learner
    method : int
    """
    axes, kinematic = learner.models.robot["motors"].axes, None
    done = LogFolder(folder, first, axes)
    air = LogFolder(folder / AIR, first, axes) if (folder / AIR).is_dir() else None
    if air is None and method != 1:
        raise ValueError(f"{folder / AIR}/ is missing: method {method} needs the logs of a trial in the air")
    if air is not None:
        done.zero, done.apart = air.touch_off(), air.apart
        kinematic = kinematic_error([air.signals(True, False)])
    signals = done.signals(method == 1, method == 2)
    if method == 3 and air is not None:
        told = [determined(learner.forces, *each.torques, str(each.path)) for each in (done, air)]
        signals = replace(signals, force=told[0] - told[1])
    sent = learner.corrected(first, [signals], method, kinematic)
    write_path(folder / NEXT, sent, first.path.joints(first.arm, sent))
    return folder / NEXT
