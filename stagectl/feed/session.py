"""Runs of `stagectl force` in their folder: pockets one after the other, everything recorded, measured and kept."""

import json
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from calibration.state_space.model import InnovationModel
from ctlblocks import recording
from ctlblocks.room import bytes_of
from rigkit import config as rig_file
from rigkit.disk_space import require
from rigkit.json_file import read_json
from rigkit.kept_files import kept_files
from rigkit.provenance import now, software
from rigkit.run_folder import CONFIG, RunFolder, read_events
from rigkit.run_origin import keep_origin
from stagectl.devices.signals import ROBOT
from stagectl.feed.job import Job, Repeated, once, read_job
from stagectl.feed.measures import Strip, as_milled, figures, retold, safe_feeds, strips
from stagectl.feed.plan import RATE as FRAMES
from stagectl.feed.plan import FeedPlan, feed_plan
from stagectl.feed.recorded import FORCE, SLOW, TRUE, made
from stagectl.feed.run import LONGEST, Pocketed, mill_pocket
from stagectl.feed.surroundings import plants_of, simulated
from stagectl.model_file import read_model
from stagectl.model_origin import refuse_other_wiring
from stagectl.planning.milling import Milled, Planner
from stagectl.planning.problem import Pocket
from stagectl.planning.segment_file import write_segments
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.trials.conduct import Conduct
from stagectl.wire.egm import RATE

Perform = Callable[[FeedPlan, Planner, Conduct], Pocketed]
"""Mills a pocket: `mill_simulated`, or `live.LivePockets`."""
JOB, MODEL, FEEDS, SEGMENTS = "job.json", "velocity.h5", "feeds.json", "segments.csv"


@dataclass(frozen=True)
class Kept:
    """A pocket of a run's folder.

    Parameters
    ----------
    plan : FeedPlan
    done : Pocketed
    """

    plan: FeedPlan
    done: Pocketed


def velocity_model(file: Path | None) -> InnovationModel:
    """Return the robot's velocity model: that of a file, or the nominal one."""
    return nominal_velocity(RATE) if file is None else read_model(file, rate=RATE)


def require_room(path: Path, plan: FeedPlan, job: Job) -> None:
    """Refuse, by a `DiskFault`, pockets that the disk has no room for, each as long as it may be.

    Parameters
    ----------
    path : Path
        Folder of the run; need not exist.
    plan : FeedPlan
        Of the first pocket.
    job : Job
    """
    pockets, channels = job.pockets + job.compares, sum(signal.width for signal in recorded_of(plan))
    one = bytes_of(round(LONGEST * FRAMES / SLOW), channels, "float64", "csv")
    require(path, pockets * one, f"pockets of {LONGEST:g} s")


def refuse_foreign_model(cell: CellConfig, model: Path | None, accept: Collection[str]) -> list[str]:
    """Refuse a velocity model of a cell that was wired otherwise, by DisagreementError; return what is to be said.

    Parameters
    ----------
    cell : CellConfig
    model : Path or None
    accept : collection of str
        Keys that may differ.
    """
    known = velocity_model(model)
    return [] if model is None else refuse_other_wiring(cell, model, known.provenance, accept, "cell")


def create(path: Path, cell: CellConfig, job: Job, model: Path | None, accept: Collection[str] = ()) -> RunFolder:
    """Make the folder of a new run, with copies of all files; ValueError where something is in it already."""
    files = kept_files(cell, ["learning.model"])
    with RunFolder.filled(path, rig_file.dump(files.config)) as folder:
        folder.write(JOB, job.text())
        parts = [JOB, *files.take_into(folder)]
        if model is not None:
            folder.take_in(model, MODEL)
            parts.append(MODEL)
        keep_origin(folder, "force run", files.config, parts, sorted(accept))
    return folder


def mill_pockets(
    cell: CellConfig,
    pocket: Pocket,
    planner: Planner,
    model: InnovationModel,
    conduct: Conduct,
    pockets: int = 1,
    compares: bool = False,
    perform: Perform | None = None,
) -> Iterator[Kept]:
    """Mill pocket after pocket, each in a piece of its own, until one is held.

    Parameters
    ----------
    cell : CellConfig
    pocket : Pocket
    planner : Planner
        Goes on learning from pocket to pocket.
    model : InnovationModel
    conduct : Conduct
        Is shown the cells that are milled.
    pockets : int
    compares : bool
        Whether the last pocket is milled once more, the same way, by position control at the safe feed.
    perform : Perform, optional
        Mills one; in the simulated cell if not given.

    Raises
    ------
    ValueError : plants that do not take their options, or a pocket out of reach; before the first one is milled.
    """
    milled: list[Strip] = []
    area = pocket.rows * pocket.cols
    mills = perform or mill_simulated
    for piece in range(1, pockets + 1):
        plan = feed_plan(cell, pocket, model, piece)
        done = mills(plan, planner, _after(conduct, (piece - 1) * area))
        yield Kept(plan, done)
        if done.reason:
            return
        milled += strips(done, cell)
    if compares:
        plan = feed_plan(cell, pocket, model, pockets, safe_feeds(milled, pocket.types))
        again = Repeated([each.cut for each in done.segments])
        yield Kept(plan, mills(plan, again, _after(conduct, pockets * area)))


def simulated_pockets(
    cell: CellConfig, pocket: Pocket, planner: Planner, pockets: int, conduct: Conduct
) -> list[list[Milled]]:
    """Mill pockets by force control in the simulated cell; return the segments of each, as measured.

    Parameters
    ----------
    cell : CellConfig
    pocket : Pocket
    planner : Planner
    pockets : int
    conduct : Conduct
        Is shown the cells that are milled.

    Raises
    ------
    ValueError : as of `mill_pockets`, or the cell was held, by its reason.
    """
    model, found = velocity_model(None), []
    for each in mill_pockets(cell, pocket, planner, model, conduct, pockets):
        if each.done.reason:
            raise ValueError(f"pocket {each.plan.piece} was held: {each.done.reason}")
        found.append(as_milled(each.done))
    return found


def _after(conduct: Conduct, before: int) -> Conduct:
    """Return the conduct of a pocket after so many cells `before` it."""
    return replace(conduct, show=lambda cells: conduct.show(before + cells))


def mill_simulated(plan: FeedPlan, planner: Planner, conduct: Conduct) -> Pocketed:
    """Mill a pocket in the simulated cell; ValueError for plants that do not take their options."""
    plants_of(plan)  # a wrong option is told before anything is written
    return mill_pocket(plan, once(planner), conduct, simulated, recorded_of(plan), about(plan))


def recorded_of(plan: FeedPlan) -> tuple[Any, ...]:
    """Return the signals of a simulated run's recording."""
    return (*ROBOT, *FORCE, *TRUE, *made(plan.control))


def keep(folder: RunFolder, kept: Kept) -> None:
    """Write what came of a pocket into the run's folder."""
    plan, done = kept.plan, kept.done
    recording.write(folder.path / f"{plan.name}.csv", done.recording)
    if plan.feeds is not None:
        folder.write(FEEDS, json.dumps(dict(plan.feeds), indent=2))
    path_milled = [each.in_path for each in done.segments]
    folder.event("milled", {"name": plan.name, "reason": done.reason, "path": path_milled})


def keep_all(folder: RunFolder, pockets: Iterable[Kept]) -> dict[str, Any]:
    """Keep pocket after pocket as they are milled, then finished segments and figures; return those."""
    kept = []
    for each in pockets:
        keep(folder, each)
        kept.append(each)
    write_segments(folder.path / SEGMENTS, milled_by_force(kept))
    found = summary(kept)
    folder.summarise(found)
    return found


def milled_by_force(pockets: list[Kept]) -> list[list[Milled]]:
    """Return the finished segments of the pockets under force control."""
    return [as_milled(each.done) for each in pockets if each.plan.feeds is None]


def summary(pockets: list[Kept]) -> dict[str, Any]:
    """Return the figures of a run, other programs' keys.

    Returns
    -------
    dict
        `pockets`: a list of what `measures.figures` returns with `name` and `control`; and where the last one was
        milled by position control as well, `saved`: by what part force control was quicker.
    """
    rows = [
        {"name": each.plan.name, "control": each.plan.control} | figures(each.done, each.plan.cell) for each in pockets
    ]
    found: dict[str, Any] = {"pockets": rows}
    if len(rows) > 1 and rows[-1]["control"] == "position" and not rows[-1]["fault"]:
        found["saved"] = 1.0 - rows[-2]["seconds"] / rows[-1]["seconds"]
    return found


def is_recorded(path: Path) -> bool:
    """Whether a folder has a pocket."""
    return any(event["event"] == "milled" for event in read_events(path))


def read_back(path: Path) -> tuple[Job, list[Kept]]:
    """Return what a folder's run was asked to do, and every pocket that it has recorded, in their order.

    Raises
    ------
    ValueError : nothing is recorded.
    """
    cell, job = rig_file.load(path / CONFIG, CellConfig), read_job(path / JOB)
    if job.pocket is None:
        return job, []
    model = velocity_model(path / MODEL if (path / MODEL).exists() else None)
    found = []
    for event in read_events(path):
        if event["event"] != "milled":
            continue
        control, piece = event["name"].split("-")
        feeds = read_json(path / FEEDS, dict) if control == "position" else None
        plan = feed_plan(cell, job.pocket, model, int(piece), feeds)
        record = recording.read(path / f"{plan.name}.csv")
        segments = retold(event["path"], job.pocket, record)
        found.append(Kept(plan, Pocketed(record, segments, event["reason"])))
    if not found:
        raise ValueError(f"{path}: nothing is recorded")
    return job, found


def about(plan: FeedPlan) -> dict[str, str]:
    """Return the provenance of a recording that is made now."""
    return {"control": plan.control, "piece": str(plan.piece), "date": now(), "software": software()}
