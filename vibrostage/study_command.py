"""The commands `vibrostage study run` and `replay`."""

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Annotated

import typer

from rigkit.agreement import AcceptOption
from rigkit.command import JsonOption, SetOption, words, write_json
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from rigkit.study import programs
from rigkit.study.engine import Hands, Study, cores
from rigkit.study.folder import StudyFolder
from rigkit.study.local import local
from rigkit.study.plan import Plan, read_plan
from rigkit.study.results import study_hash
from vibrostage.replay_study import replay_study

OutOption = Annotated[Path, typer.Option(metavar="DIR", help="Folder of the study, new or to continue.")]
SchedulerOption = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Address of a Dask scheduler, such as tcp://lab-7:8786.")
]
WorkersOption = Annotated[
    int | None, typer.Option(min=1, max=1024, help="Processes on this computer; default: one per core.")
]


def run_command(
    study: Annotated[Path, typer.Argument(metavar="STUDY.toml", help="The study.")],
    out: OutOption,
    scheduler: SchedulerOption = None,
    workers: WorkersOption = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Run a study, or continue it with the same command after a stop or kill, or with a larger budget.

    Example: `vibrostage study run STUDY.toml --out LAWS/`
    """
    perform_study(read_plan(study, programs.names(), settings or []), out, scheduler, workers, accept or [], json)


def replay_command(
    runs: Annotated[Path, typer.Argument(metavar="RUNS/", help="Folder that contains the folders of runs.")],
    out: OutOption,
    scheduler: SchedulerOption = None,
    workers: WorkersOption = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Replay recorded runs of the vibrator with other settings, and judge the drives.

    Example: `vibrostage study replay runs/ --set learning.law=thesis --out REPLAYED/`
    """
    plan = Plan(replay_study(runs, settings or []), programs.names(), runs)
    perform_study(plan, out, scheduler, workers, accept or [], json)


def perform_study(
    plan: Plan, out: Path, scheduler: str | None, workers: int | None, accept: list[str], json: str | None
) -> None:
    """Perform the tasks of a study and say what has come of them.

    Raises
    ------
    Stopped : by Ctrl-C.
    """
    with StudyFolder(out, plan, accept) as folder:
        made = Study(folder)
        stream = words(json)
        with stoppable() as stop, progress(plan.study.name, 1.0, start=made.tally.share(made.budget)) as meter:
            for note in folder.notes:
                meter.say(note)
            with _hands(scheduler, workers, folder) as hands:
                made.run(hands, meter, stop)
        if stop.made:
            raise Stopped(f"{out}/: {made.tally.text}; the same command continues")
        rows = folder.rows()
        found = study_hash(rows, plan.figures)
    print(f"{out}/: {made.tally.text}; hash {found}", file=stream)  # noqa: T201
    write_json(json, {"tasks": len(rows), "refused": made.tally.refused, "failed": made.tally.failed, "hash": found})


def _hands(scheduler: str | None, workers: int | None, folder: StudyFolder) -> AbstractContextManager[Hands]:
    """Return what performs the tasks."""
    if scheduler is None:
        return local(workers or cores(), folder.files, folder.tasks)
    if workers is not None:
        raise ValueError("--workers is of this machine, and --scheduler has workers of its own; must be one of them")
    try:
        from rigkit.study.cluster import cluster
    except ImportError as fault:
        raise ValueError(f"--scheduler needs distributed ({fault}): pip install 'vibrostage[cluster]'") from None
    return cluster(scheduler, folder.files, f"{folder.path.absolute()} {folder.plan.study.name}")
