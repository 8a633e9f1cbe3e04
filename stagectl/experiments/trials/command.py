"""The command `stagectl ilc`: a path learned in free space, then in material."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.command import CommandLine, refuse_given
from rigkit.experiment.kept import ended_early
from rigkit.experiment.runner import STOPPED
from stagectl.experiments.trials.asked import Asked
from stagectl.experiments.trials.experiment import REFUSED, Milling
from stagectl.experiments.trials.from_logs import AIR, learn_from_logs
from stagectl.experiments.trials.learner import ALL, learner_of, wanted_methods
from stagectl.experiments.trials.log_folder import SENT, write_path
from stagectl.experiments.trials.motions import steps
from stagectl.experiments.trials.read_back import TRIALS, Files, asked_of, task_of, was_live
from stagectl.experiments.trials.report import HEAD, TABLE_HEAD, method_rows, trial_rows
from stagectl.experiments.trials.trial import TASKS, cell_for_task, first_trial
from stagectl.experiments.trials.wired import bench
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_needless_yes, refuse_unattended
from stagectl.robot.live.person import Person

PACES = {True: "in real time", False: "simulated some five times as fast"}
"""How long motions take, live and simulated."""
METHOD, ITERATIONS, TASK = "1", 4, "pocket28"
"""Unless given."""
UNTOUCHED = "no touch-off, offsets of the tracker's axes are learned as errors, and the cut is predicted by G_M"
ResumeOption = Annotated[
    Path | None,
    typer.Option(metavar="RUN/", help="Continue that run with its settings and models: the remaining trials."),
]


MethodOption = Annotated[
    str | None, typer.Option(metavar="METHOD", help=f"1, 2, 3, several as 1,2, or {ALL}.  [default: {METHOD}]")
]
IterationsOption = Annotated[
    int | None, typer.Option(help=f"Trials in material after the first one.  [default: {ITERATIONS}]", min=1, max=50)
]
LogsOption = Annotated[
    Path | None, typer.Option("--from", metavar="LOGDIR", help="Learn from the logs of one trial; run nothing.")
]
JointsOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Joint models, to compensate lost motion at reversals in the path."),
]
PlayOption = Annotated[
    Path | None, typer.Option("--path", metavar="LOGDIR", help="Write the path to play first, sent.csv; run nothing.")
]
TaskOption = Annotated[
    str | None,
    typer.Option(metavar="TASK", help=f"{', '.join(TASKS)}.  [default: {TASK}]", autocompletion=one_of(TASKS)),
]


def ilc(
    method: MethodOption = None,
    iterations: IterationsOption = None,
    task: TaskOption = None,
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for trials and report.")] = None,
    resume: ResumeOption = None,
    is_live: Annotated[bool, typer.Option("--live", help="The robot of [robot]; else the simulated cell.")] = False,
    is_sure: Annotated[bool, typer.Option("--yes", help="Live: no confirmation between trials.")] = False,
    dry: Annotated[bool, typer.Option("--dry-run", help="Print every motion of a live run; nothing moves.")] = False,
    logs: LogsOption = None,
    play: PlayOption = None,
    config: ConfigOption = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Models; else learning.model.")] = None,
    joints: JointsOption = None,
    png: PngOption = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Learn to mill a pocket: free space first, then trials in material; errors as in Table 5.1, paths, a report.

    Method 1 learns from what the tracker sees, 2 from motor angles and the force sensor, 3 from motor angles and the
    force estimated from motor torques.  For a trial that is run elsewhere --path writes what to play, and --from reads
    its logs and writes the path to send next into that folder.

    Live, it asks before each trial: for no block, or for a fresh one.  Ctrl-C in a trial lifts the tool out.  After a
    stop or kill --resume continues with the trial in progress; --iterations or --method extend a run.

    Examples: `stagectl ilc --config cell.toml --method 1 --iterations 4 --task pocket28 --out RUN/`,
    `stagectl ilc --config cell.toml --method 1 --live --out RUN/`, `stagectl ilc --resume RUN/ --iterations 8`,
    `stagectl ilc --method 3 --from LOGDIR/`
    """
    if resume is not None:
        given = {"--out": out, "--config": config, "--model": model, "--joints": joints, "--task": task, "--from": logs}
        refuse_given({**given, "--set": settings, "--live": is_live or None, "--dry-run": dry or None})
        _go_on(_line(was_live(resume), resume, png, json), resume, method, iterations, accept or [], is_sure)
        return
    if logs is not None:
        _refuse_with_logs({"--live": is_live, "--dry-run": dry, "--out": out is not None, "--png": png is not None})
    methods, some = wanted_methods(method or METHOD), iterations or ITERATIONS
    refuse_needless_yes(is_sure, is_live)
    cell = cell_for_task(rig_file.load(config, CellConfig, settings or []), task or TASK, is_live)
    files = Files(task or TASK, model or Path(cell.learning.model), joints)
    if play is not None:
        _say_path(play, cell, files, accept or [], json)
    elif dry:
        _say_steps(cell, files.task, 1 + some * len(methods))
    elif logs is not None:
        _say_next(logs, cell, files, methods, accept or [], json)
    elif out is None:
        raise ValueError("--out is missing: the folder of the trials")
    else:
        _run(_line(is_live, out, png, json), cell, files, methods, some, accept or [], is_sure)


def _run(
    line: CommandLine,
    cell: CellConfig,
    files: Files,
    methods: tuple[int, ...],
    iterations: int,
    accept: list[str],
    is_sure: bool,
) -> None:
    """Run all trials into a new folder."""
    assert line.out is not None
    if line.is_live:
        refuse_unattended(cell, is_sure)
    made = _asked(line, cell, methods, iterations, accept, is_sure).new(cell, files)
    _say_how_long(made, line)
    reasons, found = line.carry_out(TRIALS, cell, made, take_more=files.take_into, accept=sorted(accept))
    _tell(reasons, found, line.out, line)


def _line(is_live: bool, out: Path, png: Path | None, json: str | None) -> CommandLine:
    return CommandLine("trials", is_live, out, png, json)


def _asked(
    line: CommandLine, cell: CellConfig, methods: tuple[int, ...], iterations: int, accept: list[str], is_sure: bool
) -> Asked:
    def say(text: str) -> None:
        print(text, file=words(line.json), flush=True)  # noqa: T201

    person = Person(say, not is_sure) if line.is_live else None
    return Asked(methods, iterations, bench(cell, person), accept, _note, say)


def _go_on(
    line: CommandLine, path: Path, method: str | None, iterations: int | None, accept: list[str], is_sure: bool
) -> None:
    """Go on with a run, as it was asked for unless it is asked for otherwise."""
    refuse_needless_yes(is_sure, line.is_live)
    cell, _ = task_of(path)
    if line.is_live:
        refuse_unattended(cell, is_sure)
    methods, some = asked_of(path)
    asked = _asked(line, cell, wanted_methods(method) if method else methods, iterations or some, accept, is_sure)
    reasons, found = line.go_on(TRIALS, asked.going_on(path))
    _tell(reasons, found, path, line)


def _tell(reasons: dict[str, str], found: dict[str, Any], path: Path, line: CommandLine) -> None:
    """Print the tables; raise ValueError where a fault has ended a trial, or methods were refused."""
    stream = words(line.json)
    print_table(f"{path}: errors of every trial", HEAD, trial_rows(found), stream)
    if found["methods"]:
        print_table(f"{path}: as Table 5.1", TABLE_HEAD, method_rows(found), stream)
    write_json(line.json, found)
    line.end(reasons)
    for name, reason in reasons.items():
        if reason != STOPPED:
            raise ValueError(f"{ended_early(name, reason)}; what is recorded is in {path}/")
    if refused := found.get(REFUSED):
        told = "; ".join(f"method {method}: {why}" for method, why in refused.items())
        raise ValueError(f"{told}; what is recorded is in {path}/")


def _say_how_long(made: Milling, line: CommandLine) -> None:
    text = f"{len(made.left)} trials of {made.first.path.seconds:.0f} s each, {PACES[line.is_live]}"
    print(text, file=words(line.json), flush=True)  # noqa: T201


def _refuse_with_logs(given: dict[str, bool]) -> None:
    for name in (name for name, is_given in given.items() if is_given):
        raise ValueError(f"{name} and --from are given, must be one of them: nothing is run, LOGDIR gets the path")


def _say_path(folder: Path, cell: CellConfig, files: Files, accept: list[str], json: str | None) -> None:
    """Write the path as learning begins with it, for who plays and logs it, in the air and cut."""
    first = first_trial(cell, files.task)
    if (folder / SENT).exists():
        raise ValueError(f"{folder / SENT} is there already, must be another folder: its logs belong to that path")
    if files.joints is not None:
        learner = learner_of(cell, files.model, first, (), accept, _note, files.joints)
        first = replace(first, sent=first.sent + learner.carried(first))
    folder.mkdir(parents=True, exist_ok=True)
    write_path(folder / SENT, first.sent, first.joints)
    text = (
        f"{folder / SENT}: {first.path.samples} samples, {first.path.seconds:g} s at 250 a second: play it and log it"
    )
    print(text, file=words(json))  # noqa: T201
    write_json(json, {"path": str(folder / SENT), "samples": first.path.samples})


def _say_next(
    logs: Path, cell: CellConfig, files: Files, methods: tuple[int, ...], accept: list[str], json: str | None
) -> None:
    if len(methods) != 1:
        raise ValueError(f"--method is {methods}, must be one with --from")
    first = first_trial(cell, files.task)
    learner = learner_of(cell, files.model, first, methods, accept, _note, files.joints)
    path = learn_from_logs(logs, first, learner, methods[0])
    if not (logs / AIR).is_dir():
        print(f"{logs / AIR}/ is not there: {UNTOUCHED}", file=words(json))  # noqa: T201
    print(f"the path to send next: {path}", file=words(json))  # noqa: T201
    write_json(json, {"path": str(path)})


def _note(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def _say_steps(cell: CellConfig, task: str, trials: int) -> None:
    for number, each in enumerate(steps(cell, first_trial(cell, task), trials), start=1):
        typer.echo(f"{number:3d}  {each}")
