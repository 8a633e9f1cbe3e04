"""The command `stagectl ilc`: a path learned in free space, then in material."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, TextIO

import typer

from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.run_folder import RunFolder
from rigkit.stop import stoppable
from stagectl.machining.run import Conduct
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import MillingModels, read_milling
from stagectl.robot.milling.torque_file import read_force_model
from stagectl.robot.milling.trial_error import METHODS, kinematic_error
from stagectl.trials.campaign import FIRST, Learner, determined, learn_free_space, learn_pocket
from stagectl.trials.done import DoneTrial
from stagectl.trials.log_folder import LogFolder, write_logs, write_path
from stagectl.trials.report import HEAD, TABLE_HEAD, figures, method_rows, trial_report, trial_rows
from stagectl.trials.session import LEARNING, Runner, grouped, read_back, run_simulated
from stagectl.trials.surroundings import refuse_wrong_plants
from stagectl.trials.tool_path import RATE
from stagectl.trials.trial import TASKS, Trial, cell_for_task, first_trial

ALL, PAGE, LOGS, AIR, NEXT = "all", "report.html", "logs", "free", "next.csv"


def ilc(
    method: Annotated[str, typer.Option(metavar="METHOD", help=f"1, 2, 3, several as 1,2, or {ALL}.")] = "1",
    iterations: Annotated[int, typer.Option(help="Trials in material after the first one.", min=1, max=50)] = 4,
    task: Annotated[str, typer.Option(metavar="TASK", help=f"{', '.join(TASKS)}.")] = "pocket28",
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for trials and report.")] = None,
    logs: Annotated[
        Path | None, typer.Option("--from", metavar="LOGDIR", help="Learn from the logs of one trial; run nothing.")
    ] = None,
    config: ConfigOption = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Models; else learning.model.")] = None,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the figures as PNG files as well.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Learn to mill a pocket: free space first, then trials in material; errors as in Table 5.1, paths, a report.

    Method 1 learns from what the tracker sees, 2 from motor angles and the force sensor, 3 from motor angles and the
    force estimated from motor torques.  With --from it reads the logs of a trial that was run elsewhere, and writes
    the path to send next into that folder.

    Examples: `stagectl ilc --config cell.toml --method 1 --iterations 4 --task pocket28 --out RUN/`,
    `stagectl ilc --method 3 --from LOGDIR/`
    """
    methods = wanted_methods(method)
    cell = cell_for_task(rig_file.load(config, CellConfig, settings or []), task)
    first = first_trial(cell, task)
    learner = learner_of(cell, model or Path(cell.learning.model), first, methods)
    if logs is not None:
        if len(methods) != 1:
            raise ValueError(f"--method is {method!r}, must be one with --from")
        path = learn_from_logs(logs, first, learner, methods[0])
        print(f"the path to send next: {path}", file=words(json))  # noqa: T201
        write_json(json, {"path": str(path)})
        return
    if out is None:
        raise ValueError("--out is missing: trials are kept there")
    found = _learned(out, task, first, learner, methods, iterations, png, words(json))
    write_json(json, found)


def _learned(
    out: Path, task: str, first: Trial, learner: Learner, methods: tuple[int, ...], iterations: int,
    png: Path | None, stream: TextIO,
) -> dict[str, Any]:  # fmt: skip
    """Run all trials of all methods; keep, report and tell of them."""
    for each in (None, *methods):
        learner.contraction(each).refuse_divergence()
    refuse_wrong_plants(first)

    def tell(text: str) -> None:
        print(text, file=stream, flush=True)  # noqa: T201

    with RunFolder.create(out, rig_file.dump(learner.cell)) as folder, stoppable() as stop:
        folder.write(LEARNING, f"{task}\n")
        runner = Runner(folder, Conduct(folder.event, lambda: stop.made), run_simulated, tell)

        def run(name: str, trial: Trial) -> DoneTrial:
            done = runner(name, trial)
            write_logs(folder.path / LOGS / name, done)
            return done

        try:
            milled = run(FIRST, learn_free_space(first, learner, run))
            learned = {each: learn_pocket(milled, learner, each, iterations, run) for each in methods}
        finally:
            found = report_again(folder.path, png)
            folder.summarise(found)
    print_table(f"{out}: errors of every trial", HEAD, trial_rows(learner.free, learned), stream)
    print_table(f"{out}: as Table 5.1", TABLE_HEAD, method_rows(learned), stream)
    tell(f"report: {out / PAGE}")
    return found


def wanted_methods(text: str) -> tuple[int, ...]:
    """Read "1", "1,3" or "all"; ValueError for anything else."""
    known = {str(each): each for each in METHODS}
    found = list(known.values()) if text == ALL else [known.get(part.strip(), 0) for part in text.split(",")]
    if not all(found):
        raise ValueError(f"--method is {text!r}, must be {', '.join(known)}, several of them, or {ALL}")
    return tuple(dict.fromkeys(found))


def learner_of(cell: CellConfig, file: Path, first: Trial, methods: tuple[int, ...]) -> Learner:
    """Read the models that methods need.

    Parameters
    ----------
    cell : CellConfig
    file : Path
    first : Trial
    methods : tuple of int

    Raises
    ------
    ValueError : no such file, or one without what they need.
    """
    models: MillingModels = read_milling(file)
    if 3 not in methods:
        return Learner(cell, models)
    known = read_force_model(file, first.arm, cell.force_estimate.tie_break)
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
    sent = learner.corrected(first, signals, method, kinematic)
    write_path(folder / NEXT, sent, first.path.joints(first.arm, sent))
    return folder / NEXT


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
