"""The commands `vibrostage study`."""

import tomllib
from contextlib import AbstractContextManager
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from rigkit.agreement import AcceptOption
from rigkit.command import JsonOption, SetOption, application, print_table, words, write_json
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from rigkit.study import programs
from rigkit.study.comparison import difference, ends_differently, is_within, matched
from rigkit.study.engine import Hands, Study, cores
from rigkit.study.folder import StudyFolder
from rigkit.study.local import local
from rigkit.study.plan import Plan, read_plan
from rigkit.study.report import PAGE, StudyReport
from rigkit.study.results import study_hash
from rigkit.study.tables import case_name
from vibrostage.replay_study import replay_study

study_app = application("Run any command over plants, seeds and settings, on every core or a cluster.")

OutOption = Annotated[Path, typer.Option(metavar="DIR", help="Folder of the study, new or to continue.")]
SchedulerOption = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Address of a Dask scheduler, such as tcp://lab-7:8786.")
]
WorkersOption = Annotated[
    int | None, typer.Option(min=1, max=1024, help="Processes on this computer; default: one per core.")
]


@study_app.command("example")
def example_command(json: JsonOption = None) -> None:
    """Print a small study: two learning laws on three simulated vibrators, a minute on two cores.

    Example: `vibrostage study example > STUDY.toml`
    """
    text = files("vibrostage").joinpath("quick.toml").read_text(encoding="utf-8")
    words(json).write(text)
    write_json(json, tomllib.loads(text))


@study_app.command("run")
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


@study_app.command("replay")
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


@study_app.command("report")
def report_command(
    path: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study, or a file of its results.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The page; default: DIR/report.html, none for a file.")
    ] = None,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the figures as PNG files as well.")] = None,
    json: JsonOption = None,
) -> None:
    """Report a study: distributions, survival curves, and the worst cases with the commands that repeat them.

    Example: `vibrostage study report LAWS/ --json laws.json`
    """
    found = StudyReport.of(path)
    stream = words(json)
    for text, table in found.tables():
        print_table(text, table.head, table.rows, stream)
    for line in found.lines():
        print(line, file=stream)  # noqa: T201
    target = path / PAGE if out is None and path.is_dir() else out
    if target is not None or png is not None:
        page = found.page()
        if target is not None:
            page.write(target)
            print(f"report: {target}", file=stream)  # noqa: T201
        if png is not None:
            page.png(png)
    write_json(json, found.told())


@study_app.command("compare")
def compare_command(
    one: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study, or a file of its results.")],
    other: Annotated[
        Path, typer.Argument(metavar="OTHER", help="The same study, from elsewhere or by other software.")
    ],
    tolerance: Annotated[
        float, typer.Option(min=0.0, help="Relative to the larger value; 0 for identical bits.")
    ] = 0.0,
    json: JsonOption = None,
) -> None:
    """Compare two results of a study task by task; status 1 where a figure differs by more than the tolerance.

    Example: `vibrostage study compare LAWS/ ELSEWHERE/ --tolerance 1e-9`
    """
    first, second = StudyReport.of(one), StudyReport.of(other)
    pairs = matched(first.rows, second.rows)
    common = {name: figure for name, figure in first.about.figures.items() if name in second.about.figures}
    found = {name: difference(pairs, name, figure) for name, figure in common.items()}
    ends = ends_differently(pairs)
    rows = [
        [
            name,
            str(each.count),
            str(each.differing),
            f"{each.largest:.3g}",
            case_name(each.worst) if each.worst else "-",
        ]
        for name, each in found.items()
    ]
    head = ["figure", "tasks", "other bits", "largest difference, of the value", "in"]
    print_table(f"{one} and {other}: {len(pairs)} tasks, {len(ends)} end otherwise", head, rows, words(json))
    is_same = not ends and is_within(found, common, tolerance)
    figures = {name: {"differing": each.differing, "largest": each.largest} for name, each in found.items()}
    write_json(json, {"tasks": len(pairs), "ends": len(ends), "within": is_same, "figures": figures})
    if not is_same:
        raise typer.Exit(1)


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
