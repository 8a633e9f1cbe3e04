"""The command `stagectl force`: milling with the force controlled by the feed, segment by segment."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from ctlblocks import clock
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, laid_over, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.command import CommandLine, refuse_png_alone
from rigkit.experiment.runner import STOPPED
from rigkit.written import written_file
from stagectl.experiments.feed.bench import SimulatedBench
from stagectl.experiments.feed.job import POCKETS, PROCESS, Job, pocket_of
from stagectl.experiments.feed.plan import feed_plan
from stagectl.experiments.feed.process import process_rows
from stagectl.experiments.feed.read_back import FORCE, Files
from stagectl.experiments.feed.report import HEAD, TYPE_HEAD, pocket_rows, type_rows
from stagectl.experiments.feed.wired import WiredBench, steps
from stagectl.planning.planner_names import PLANNERS, UNTRAINED
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_needless_yes, refuse_unattended
from stagectl.robot.live.person import Person

Task = Annotated[
    str,
    typer.Option(
        metavar="TASK",
        help=f"{', '.join(POCKETS)}, POCKET.json, or {PROCESS}.",
        autocompletion=one_of([*POCKETS, PROCESS]),
    ),
]
Newtons = Annotated[float | None, typer.Option("--force", metavar="N", help="Set-point of the force.")]
Out = Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for recordings and report.")]
Model = Annotated[Path | None, typer.Option(metavar="FILE", help="The robot's velocity model.")]
Name = Annotated[
    str, typer.Option("--planner", metavar="NAME", help=f"{', '.join(PLANNERS)}.", autocompletion=one_of(PLANNERS))
]
Untrained = Annotated[
    bool, typer.Option("--untrained", help=f"The planner does not know the rates: {', '.join(UNTRAINED)}.")
]
PriorFile = Annotated[
    Path | None,
    written_file("FILE", "uncertain stores the errors of its rates in FILE: see `stagectl plan`.", "--prior"),
]
Count = Annotated[
    int, typer.Option("--pockets", min=1, max=20, help="Number of pockets, each in a piece of wood of its own.")
]
Compares = Annotated[
    bool, typer.Option("--compare", help="Mill the last pocket once more by position control at the safe feed.")
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the planner's random numbers.")]
Paced = Annotated[bool, typer.Option("--paced", help="In real time; else as fast as possible.")]
Live = Annotated[bool, typer.Option("--live", help="The robot of [robot]; else the simulated cell.")]
Sure = Annotated[bool, typer.Option("--yes", help="Live: no confirmation between pockets.")]
Dry = Annotated[bool, typer.Option("--dry-run", help="Print every motion of a live run; nothing moves.")]


def force(
    task: Task,
    newtons: Newtons = None,
    out: Out = None,
    config: ConfigOption = None,
    model: Model = None,
    planner_name: Name = "sequential",
    is_untrained: Untrained = False,
    prior: PriorFile = None,
    pockets: Count = 1,
    compares: Compares = False,
    seed: Seed = 0,
    is_paced: Paced = False,
    is_live: Live = False,
    is_sure: Sure = False,
    dry: Dry = False,
    png: PngOption = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Mill as fast as the force allows: forces, kappa and beta with their uncertainty, feed; with the planner's order.

    Live, it asks for a fresh piece before each pocket.  Ctrl-C in a strip retracts along it and holds the robot.

    Examples: `stagectl force --config cell.toml --force 10 --task pocket --compare --out RUN/`,
    `stagectl force --config cell.toml --live --task slot --out RUN/`
    """
    cell = rig_file.load(config, CellConfig, laid_over(settings, {"force.force": newtons}))
    refuse_png_alone(png, out)
    job = Job(
        task, pocket_of(task, cell.segments), planner_name, is_untrained, pockets, seed, compares, str(prior or "")
    )
    files = Files(job, model)
    if dry:
        _say_steps(cell, files)
        return
    way = Way(is_live, is_sure, is_paced, tuple(accept or ()))
    way.refuse(cell, job, out)
    for note in files.refuse_foreign(cell, way.accept):
        sys.stderr.write(f"{note}\n")
    _run(cell, files, way, out, png, json)


@dataclass(frozen=True)
class Way:
    """How pockets are milled.

    Parameters
    ----------
    is_live, is_sure : bool
        On the robot; without asking before each pocket.
    is_paced : bool
        In real time.
    accept : tuple of str
        Keys in which the cell that the model was measured on may differ.
    """

    is_live: bool
    is_sure: bool
    is_paced: bool
    accept: tuple[str, ...] = ()

    def refuse(self, cell: CellConfig, job: Job, out: Path | None) -> None:
        """Refuse what cannot be, before anything moves or is written, by ValueError."""
        refuse_needless_yes(self.is_sure, self.is_live)
        if not self.is_live:
            return
        if job.pocket is None:
            raise ValueError(f"--live needs a pocket to mill, --task {PROCESS} has no robot")
        if self.is_paced or out is None:
            raise ValueError("--live keeps what it records in --out RUN/, and takes no --paced: the robot is its clock")
        refuse_unattended(cell, self.is_sure)


def _say_steps(cell: CellConfig, files: Files) -> None:
    job = files.job
    if job.pocket is None:
        raise ValueError(f"--dry-run needs a pocket to mill, --task {PROCESS} has no robot")
    plan = feed_plan(cell, job.pocket, files.velocity)
    for number, each in enumerate(steps(plan, job), start=1):
        typer.echo(f"{number:3d}  {each}")


def _run(cell: CellConfig, files: Files, way: Way, out: Path | None, png: Path | None, json: str | None) -> None:
    """Mill the pockets of a job, keep them where they are to be kept, and print the figures."""

    def say(text: str) -> None:
        print(text, file=words(json), flush=True)  # noqa: T201

    bench = WiredBench(cell, Person(say, not way.is_sure)) if way.is_live else SimulatedBench(way.is_paced)
    has_pocket, pace = files.job.pocket is not None, clock.Paced() if way.is_paced else clock.Offline()
    title, unit = ("cells milled", "cells") if has_pocket else ("force control", "s")
    line = CommandLine(title, way.is_live, out, png, json, pace, unit)
    made = files.experiment(cell, bench)
    reasons, found = line.carry_out(FORCE, cell, made, take_more=files.take_into, accept=sorted(way.accept))
    if has_pocket:
        _tell(found, files.job.task, json)
    else:
        print_table("force control as in fig. 7.5", ["figure", "value"], process_rows(found), words(json))
        write_json(json, found)
    line.end(reasons)
    held = [(name, reason) for name, reason in reasons.items() if reason != STOPPED]
    for name, reason in held:
        say(f"{name} was held: {reason}")
    if held:
        raise typer.Exit(1)


def _tell(found: dict[str, Any], task: str, json: str | None) -> None:
    stream = words(json)
    print_table(f"{task}: pockets", HEAD, pocket_rows(found["pockets"]), stream)
    for row in found["pockets"]:
        if row["types"]:
            print_table(f"types of {row['name']}", TYPE_HEAD, type_rows(row), stream)
    if "saved" in found:
        print(f"saved beside position control: {100 * found['saved']:.1f} %", file=stream)  # noqa: T201
    write_json(json, found)
