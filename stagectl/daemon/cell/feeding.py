"""The procedure that mills with the force controlled by the feed: pocket after pocket, segment by segment."""

from collections.abc import Iterable, Iterator

from rigkit.experiment.strips import PERIOD
from rigkit.service.paths import data_file, run_path
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge
from rigkit.stop import Stopped
from stagectl.daemon.cell.conductor import Conductor
from stagectl.daemon.cell.feeding_panels import FeedingPanels, cutting
from stagectl.daemon.cell.gauges import REFERENCE, Motion, timed
from stagectl.daemon.cell.options import ForceOptions
from stagectl.feed import session
from stagectl.feed.job import POCKETS, Job, pocket_of
from stagectl.feed.plan import feed_plan
from stagectl.feed.report import feed_report
from stagectl.feed.surroundings import plants_of
from stagectl.planning.problem import Pocket
from stagectl.robot.config import CellConfig

SOURCES = {
    **REFERENCE,
    "valid": "judged.valid",
    "along": "seen.along",
    "velocity": "seen.velocity",
    **{
        name: f"control.{output}"
        for name, output in {
            "feed": "reference", "resultant": "resultant", "kappa": "kappa", "kappa_deviation": "kappa_deviation",
            "beta": "beta", "beta_deviation": "beta_deviation", "phase": "phase",
        }.items()
    },
}  # fmt: skip


class Feeding:
    """Pockets milled by force under the daemon.

    Parameters
    ----------
    config : CellConfig
    options : ForceOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : there is no such pocket, planner or model, or the robot does not reach it; no folder is made.
    """

    def __init__(self, config: CellConfig, options: ForceOptions, desk: Desk) -> None:
        self._conductor, self._desk = Conductor(desk, SOURCES, options.paced), desk
        data = config.daemon.data
        wanted = options.force or config.force.force
        self._cell = config.model_copy(update={"force": config.force.model_copy(update={"force": wanted})})
        task = options.task if options.task in POCKETS else str(data_file(data, "task", options.task, POCKETS))
        pocket = pocket_of(task, config.segments)
        assert pocket is not None, "a task of `POCKETS` or a file has one"
        self._pocket: Pocket = pocket
        self._job = Job(
            task, pocket, options.planner, options.untrained, options.pockets, options.seed, options.compare
        )
        model = data_file(data, "model", options.model) if options.model else None
        for note in session.refuse_foreign_model(config, model, options.accept):
            desk.event("note", {"text": note})
        self._planner, self._known = self._job.make(), session.velocity_model(model)
        first = feed_plan(self._cell, pocket, self._known)
        plants_of(first)
        self._motion = Motion(first.cell)
        self._panels = FeedingPanels(desk, self._conductor.watch, wanted)
        path = run_path(config.daemon.data, options.run)
        session.require_room(path, first, self._job)
        self._folder = session.create(path, self._cell, self._job, model, options.accept)

    def stop(self) -> None:
        """Hold the robot where it is: within `limits.stop`."""
        self._conductor.stop()

    def gauges(self) -> list[Gauge]:
        """Return where the tool is, how fast the joints turn, the force, and what is believed of the material."""
        watch = self._conductor.watch
        return [*cutting(watch, self._cell.force), *self._motion.gauges(watch), *timed(watch)]

    def run(self) -> None:
        """Mill all pockets and write the report.

        Raises
        ------
        Stopped : the desk said that it is to end.
        ValueError : the robot was held, by its reason.
        """
        conduct = self._conductor.conduct(self._folder, self._conductor.ending, self._show)
        job = self._job
        self._show(0)
        with self._folder as folder, Regularly(self._panels.draw, PERIOD):
            self._desk.recording(True)
            pockets = session.mill_pockets(
                self._cell, self._pocket, self._planner, self._known, conduct, job.pockets, job.compares
            )
            found = session.keep_all(folder, self._drawn(pockets))
            self._desk.recording(False)
        self._conductor.watch.forget()
        feed_report(self._folder.path)
        reason = found["pockets"][-1]["fault"]
        if self._conductor.ending():
            raise Stopped(f"{reason or 'ended'}; what is recorded is kept")
        if reason:
            raise ValueError(reason)
        seconds = {each["name"]: each["seconds"] for each in found["pockets"]}
        self._desk.event("finished", {"run": self._folder.path.name, "seconds": seconds})

    def _drawn(self, pockets: Iterable[session.Kept]) -> Iterator[session.Kept]:
        """Give each pocket to be kept, draw it, and wait where it is held; no more are milled when it is to end."""
        for each in pockets:
            yield each
            self._panels.draw()
            self._conductor.watch.forget()
            self._panels.keep(each)
            self._desk.event("pocket", {"name": each.plan.name, "segments": len(each.done.segments)})
            if each.done.reason:
                return
            try:
                self._conductor.between({"after": each.plan.name})
            except Stopped:
                return

    def _show(self, cells: int) -> None:
        job, pocket = self._job, self._pocket
        total = pocket.rows * pocket.cols * (job.pockets + job.compares)
        self._desk.progress(cells, total, f"{self._cell.force.force:g} N wanted")
