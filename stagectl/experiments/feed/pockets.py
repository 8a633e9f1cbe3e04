"""Milling by force as an experiment: pocket after pocket, each in a piece of its own; the planner goes on learning."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from calibration.state_space.model import InnovationModel
from ctlblocks.room import bytes_of
from rigkit.experiment.kind import Records
from rigkit.experiment.part import Part
from rigkit.experiment.runner import never
from stagectl.devices.signals import ROBOT
from stagectl.experiments.feed.bench import Bench, SimulatedBench
from stagectl.experiments.feed.feed_graph import FeedGraph
from stagectl.experiments.feed.job import Job, Repeated
from stagectl.experiments.feed.measures import Strip, as_milled, chosen, figures, retold, safe_feeds, strips
from stagectl.experiments.feed.plan import RATE, feed_plan, recorded_plan
from stagectl.experiments.feed.pocket_part import LONGEST, pocket_part
from stagectl.experiments.feed.pocketed import Kept, Pocketed
from stagectl.experiments.feed.recorded import FORCE, SLOW, TRUE, made
from stagectl.experiments.feed.report import write_report
from stagectl.experiments.feed.surroundings import plants_of, recorded
from stagectl.link.tell import Tell, nobody
from stagectl.planning.beside import PlannerBeside
from stagectl.planning.milling import Milled, Planner
from stagectl.planning.segment_file import write_segments
from stagectl.planning.strips import Cut
from stagectl.robot.config import CellConfig

SEGMENTS = "segments.csv"


@dataclass(frozen=True)
class Told:
    """What is told of a pocket beside its recording.

    Parameters
    ----------
    reason : str
        Why it ended early, or nothing.
    path : sequence of sequences or None
        Its finished segments, where version 0.1.0 has recorded it.
    feeds : mapping of str to float or None
        Of position control, likewise.
    """

    reason: str
    path: Sequence[Sequence[Any]] | None = None
    feeds: Mapping[str, float] | None = None


class Pockets:
    """Pockets milled by force control; the last one once more by position control, where that is to be compared.

    Parameters
    ----------
    cell : CellConfig
    job : Job
        With a pocket.
    model : InnovationModel
        Of the robot's velocity.
    bench : Bench, optional
        The simulated cell if not given.
    told : mapping of str to Told, optional
        Of pockets that have been milled, by name.

    Raises
    ------
    ValueError : plants that do not take their options, or a pocket out of reach.
    """

    def __init__(
        self,
        cell: CellConfig,
        job: Job,
        model: InnovationModel,
        bench: Bench | None = None,
        told: Mapping[str, Told] | None = None,
    ) -> None:
        assert job.pocket is not None
        self.cell, self.job, self.pocket = cell, job, job.pocket
        self._model, self._bench, self._told = model, bench or SimulatedBench(), dict(told or {})
        self.first = feed_plan(cell, self.pocket, model)
        if told is None and not self.is_live:
            plants_of(self.first)

    @property
    def is_live(self) -> bool:
        """Whether the robot is behind its wires."""
        return not isinstance(self._bench, SimulatedBench)

    @property
    def seconds(self) -> float:
        """Cells of all pockets: how long they take nobody knows."""
        return float(self.pocket.rows * self.pocket.cols * (self.job.pockets + self.job.compares))

    @property
    def about(self) -> dict[str, str]:
        """Provenance of the recordings."""
        return {"cell": "live" if self.is_live else "simulated"}

    @property
    def designed(self) -> dict[str, Any]:
        """Nothing that its job does not say."""
        return {"live": self.is_live}

    @property
    def room(self) -> int:
        """Bytes that the recordings may take, each as long as it may be."""
        pockets = self.job.pockets + self.job.compares
        channels = sum(signal.width for signal in (*ROBOT, *FORCE, *TRUE, *made("force")))
        return pockets * bytes_of(round(LONGEST * RATE / SLOW), channels, "float64", "wav")

    def parts(self, tell: Tell = nobody, stopped: Callable[[], bool] = never) -> Iterator[Part]:
        """Give a part for each pocket.

        Raises
        ------
        ValueError : a piece out of reach; no segment was controlled for long enough to tell a safe feed.
        LinkError, Stopped : as of the bench.
        """
        milled = list[Strip]()
        with PlannerBeside(self.job.make(), self.pocket, tell, self._bench.patience) as planner:
            for piece in range(1, self.job.pockets + 1):
                plan = feed_plan(self.cell, self.pocket, self._model, piece)
                with self._bench.part(plan, planner, tell, stopped) as part:
                    kept = part.in_memory("kept")
                    yield replace(part, counts=planner.counts)
                record = kept()[plan.name]
                done = Pocketed(record, retold(record, self.pocket), "")
                milled += strips(done, self.cell)
                tell("pocket", {"name": plan.name, "segments": len(done.segments)})
        if self.job.compares:
            feeds = safe_feeds(milled, self.pocket.types)
            plan = feed_plan(self.cell, self.pocket, self._model, self.job.pockets, feeds)
            same = Repeated([each.cut for each in done.segments], self.pocket)
            with self._bench.part(plan, same, tell, stopped) as part:
                yield part
        self._bench.leave(tell, stopped)

    def again(self, records: Records) -> Iterator[Part]:
        """Give a part for each pocket that is recorded, its sensors and the strips that were chosen as they were.

        Where version 0.1.0 has recorded it, without the strips, the planner chooses them again.
        """
        planner: Planner | None = None
        cuts: list[Cut] = []
        for each in self.kept(records):
            record = each.done.recording
            same: Planner
            if each.plan.feeds is None:
                cuts = [segment.cut for segment in each.done.segments]
            if "cut_1" in record.names:
                same = Repeated(chosen(record), self.pocket)
            elif each.plan.feeds is not None:
                same = Repeated(cuts, self.pocket)
            else:
                same = planner = planner or self.job.make()
            yield pocket_part(FeedGraph(each.plan, partial(_given, same), nobody, recorded(each.done.recording)))

    def kept(self, records: Records) -> list[Kept]:
        """Return the pockets that are recorded, in their order."""
        found = []
        for name in sorted(records, key=_order):
            record, told = records[name], self._told.get(name, Told(""))
            plan = recorded_plan(self.cell, self.pocket, self._model, record, name, told.feeds)
            found.append(Kept(plan, Pocketed(record, retold(record, self.pocket, told.path), told.reason)))
        return found

    def milled(self, records: Records) -> list[list[Milled]]:
        """Return the finished segments of the pockets under force control, as measured."""
        return milled_by_force(self.kept(records))

    def figures(self, records: Records) -> dict[str, Any]:
        """Return what a run comes to: as of `summary`."""
        if not (kept := self.kept(records)):
            raise ValueError("nothing is recorded")
        return summary(kept)

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report, and the finished segments as a planner learns from them."""
        kept = self.kept(records)
        write_report(path, self.job.task, kept, figures, png)
        write_segments(path / SEGMENTS, milled_by_force(kept))


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


def milled_by_force(pockets: Sequence[Kept]) -> list[list[Milled]]:
    """Return the finished segments of the pockets under force control."""
    return [as_milled(each.done) for each in pockets if each.plan.feeds is None]


def _given(planner: Planner) -> Planner:
    return planner


def _order(name: str) -> tuple[bool, int]:
    """Return where a pocket stands: those under force control first."""
    control, _, piece = name.rpartition("-")
    return control != "force", int(piece)
