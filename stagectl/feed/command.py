"""The command `stagectl force`: milling with the force controlled by the feed, segment by segment."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TextIO

import typer

from ctlblocks import clock
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, laid_over, print_table, words, write_json
from rigkit.experiment.command import refuse_png_alone
from rigkit.named_code import named_block
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from stagectl.feed import process_session, session
from stagectl.feed.job import POCKETS, PROCESS, Job, pocket_of
from stagectl.feed.live import LivePockets, steps
from stagectl.feed.plan import feed_plan
from stagectl.feed.process_run import process_figures
from stagectl.feed.report import HEAD, PAGE, TYPE_HEAD, feed_report, pocket_rows, type_rows
from stagectl.feed.surroundings import plants_of
from stagectl.link.tell import nobody
from stagectl.planning.pocket import PLANNERS, UNTRAINED
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_needless_yes, refuse_unattended
from stagectl.robot.live.person import Person
from stagectl.trials.conduct import Conduct

Task = Annotated[str, typer.Option(metavar="TASK", help=f"{', '.join(POCKETS)}, POCKET.json, or {PROCESS}.")]
Newtons = Annotated[float | None, typer.Option("--force", metavar="N", help="The force wanted.")]
Out = Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for recordings and report.")]
Model = Annotated[Path | None, typer.Option(metavar="FILE", help="The robot's velocity model.")]
Name = Annotated[str, typer.Option("--planner", metavar="NAME", help=f"{', '.join(PLANNERS)}.")]
Untrained = Annotated[
    bool, typer.Option("--untrained", help=f"The planner does not know the rates: {', '.join(UNTRAINED)}.")
]
Count = Annotated[int, typer.Option("--pockets", min=1, max=20, help="How many, each in a piece of wood of its own.")]
Compares = Annotated[
    bool, typer.Option("--compare", help="Mill the last pocket once more by position control at the safe feed.")
]
Seed = Annotated[int, typer.Option(min=0, help="Of what the planner draws.")]
Paced = Annotated[bool, typer.Option("--paced", help="In real time; else as fast as it goes.")]
Live = Annotated[bool, typer.Option("--live", help="The robot of [robot]; else the simulated cell.")]
Sure = Annotated[bool, typer.Option("--yes", help="Live: go on from pocket to pocket without asking.")]
Dry = Annotated[bool, typer.Option("--dry-run", help="Print every motion of a live run, and make none.")]


def force(
    task: Task,
    newtons: Newtons = None,
    out: Out = None,
    config: ConfigOption = None,
    model: Model = None,
    planner_name: Name = "sequential",
    is_untrained: Untrained = False,
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
    """Mill as fast as the force allows: forces, kappa and beta with their uncertainty, feed; the planner goes along.

    Live, it asks for a fresh piece before each pocket.  Ctrl-C in a strip goes back along it and holds the robot.

    Examples: `stagectl force --config cell.toml --force 10 --task pocket --compare --out RUN/`,
    `stagectl force --config cell.toml --live --task slot --out RUN/`
    """
    cell = rig_file.load(config, CellConfig, laid_over(settings, {"force.force": newtons}))
    refuse_png_alone(png, out)
    job = Job(task, pocket_of(task, cell.segments), planner_name, is_untrained, pockets, seed, compares)
    if dry:
        _say_steps(cell, job, model)
        return
    way = Way(is_live, is_sure, is_paced, tuple(accept or ()))
    way.refuse(cell, job, out)
    for note in session.refuse_foreign_model(cell, model, way.accept):
        sys.stderr.write(f"{note}\n")
    if job.pocket is None:
        _process(cell, job, model, out, png, json, way.accept)
    else:
        _tell(_pockets(cell, job, model, out, way, words(json)), out, task, json)
        if png is not None and out is not None:
            feed_report(out, png)


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


def _say_steps(cell: CellConfig, job: Job, model: Path | None) -> None:
    if job.pocket is None:
        raise ValueError(f"--dry-run needs a pocket to mill, --task {PROCESS} has no robot")
    plan = feed_plan(cell, job.pocket, session.velocity_model(model))
    for number, each in enumerate(steps(plan, job), start=1):
        typer.echo(f"{number:3d}  {each}")


def _pockets(
    cell: CellConfig, job: Job, model: Path | None, out: Path | None, way: Way, stream: TextIO
) -> dict[str, Any]:
    """Mill the pockets of a job, keep them where they are to be kept, and return the figures."""
    assert job.pocket is not None
    known = session.velocity_model(model)
    plan = feed_plan(cell, job.pocket, known)
    if out is not None:
        session.require_room(out, plan, job)
    if way.is_live:
        assert out is not None  # a live run without it is refused
        return _live(cell, job, model, out, way, stream)
    plants_of(plan)  # whatever is wrong is told before there is a folder
    made, cells = job.make(), job.pocket.rows * job.pocket.cols
    pace = clock.Paced() if way.is_paced else clock.Offline()
    with stoppable() as stop, progress("cells milled", cells * (job.pockets + job.compares)) as meter:
        conduct = Conduct(nobody, lambda: stop.made, meter.show, pace.advance)
        pockets = session.mill_pockets(cell, job.pocket, made, known, conduct, job.pockets, job.compares)
        if out is None:
            found = session.summary(list(pockets))
        else:
            with session.create(out, cell, job, model, way.accept) as folder:
                found = session.keep_all(folder, pockets)
            feed_report(out)
    if stop.made:
        raise Stopped(f"stopped{'' if out is None else f'; what is recorded is in {out}'}")
    return found


def _live(cell: CellConfig, job: Job, model: Path | None, out: Path, way: Way, stream: TextIO) -> dict[str, Any]:
    """Mill them on the robot; a folder in which nothing was recorded is taken away."""

    def tell(text: str) -> None:
        print(text, file=stream, flush=True)  # noqa: T201

    assert job.pocket is not None
    known = session.velocity_model(model)
    with stoppable() as stop, session.create(out, cell, job, model, way.accept) as folder:
        conduct = Conduct(folder.event, lambda: stop.made)
        live = LivePockets(cell, Person(tell, not way.is_sure))
        pockets = session.mill_pockets(
            cell, job.pocket, job.make(), known, conduct, job.pockets, job.compares, perform=live
        )
        try:
            found = session.keep_all(folder, pockets)
            live.leave(conduct)
        finally:
            if session.is_recorded(folder.path):
                feed_report(out)
            else:
                folder.withdraw()
    if stop.made:
        raise Stopped(f"stopped; what is recorded is in {out}")
    return found


def _process(
    cell: CellConfig,
    job: Job,
    model: Path | None,
    out: Path | None,
    png: Path | None,
    json: str | None,
    accept: tuple[str, ...],
) -> None:
    known = session.velocity_model(model)
    named_block(cell.feed_plants.process, cell.feed_plants.process_options)
    if out is None:
        found = process_figures(process_session.simulate(cell, known), cell.force.force)
    else:
        with session.create(out, cell, job, model, accept) as folder:
            found = process_session.keep(folder, process_session.simulate(cell, known), cell)
        process_session.process_report(out, png)
    print_table("force control as in fig. 7.5", ["figure", "value"], process_session.process_rows(found), words(json))
    if out is not None:
        print(f"report: {out / PAGE}", file=words(json))  # noqa: T201
    write_json(json, found)


def _tell(found: dict[str, Any], out: Path | None, task: str, json: str | None) -> None:
    stream = words(json)
    print_table(f"{task}: pockets", HEAD, pocket_rows(found["pockets"]), stream)
    for row in found["pockets"]:
        if row["types"]:
            print_table(f"types of {row['name']}", TYPE_HEAD, type_rows(row), stream)
    if "saved" in found:
        print(f"saved beside position control: {100 * found['saved']:.1f} %", file=stream)  # noqa: T201
    if out is not None:
        print(f"report: {out / PAGE}", file=stream)  # noqa: T201
    write_json(json, found)
    held = [row for row in found["pockets"] if row["fault"]]
    for row in held:
        print(f"{row['name']} was held: {row['fault']}", file=stream)  # noqa: T201
    if held:
        raise typer.Exit(1)
