"""Milling by force under the daemon: what is measured, believed and drawn while pockets are milled."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from rigkit.experiment.kept import create, records_of
from rigkit.experiment.procedure import ExperimentProcedure
from rigkit.experiment.watch import Watch
from rigkit.service.paths import data_file, run_path
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge, Panel
from stagectl.daemon.cell_gauges import REFERENCE, Motion, timed
from stagectl.experiments.feed.bench import SimulatedBench
from stagectl.experiments.feed.job import POCKETS, Job, pocket_of
from stagectl.experiments.feed.options import ForceOptions
from stagectl.experiments.feed.panels import cutting, lately, tables
from stagectl.experiments.feed.pockets import Pockets
from stagectl.experiments.feed.read_back import FORCE, Files
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


def procedure(config: CellConfig, options: ForceOptions, desk: Desk) -> ExperimentProcedure:
    """Return pockets milled by force, one after another.

    Parameters
    ----------
    config : CellConfig
    options : ForceOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : there is no such pocket, planner or model, or the robot does not reach it; no folder is made.
    """
    data, wanted = config.daemon.data, options.force or config.force.force
    cell = config.model_copy(update={"force": config.force.model_copy(update={"force": wanted})})
    task = options.task if options.task in POCKETS else str(data_file(data, "task", options.task, POCKETS))
    pocket = pocket_of(task, config.segments)
    assert pocket is not None, "a task of `POCKETS` or a file has one"
    prior = str(Path(data) / options.prior) if options.prior else ""
    job = Job(task, pocket, options.planner, options.untrained, options.pockets, options.seed, options.compare, prior)
    files = Files(job, data_file(data, "model", options.model) if options.model else None)
    for note in files.refuse_foreign(config, options.accept):
        desk.event("note", {"text": note})
    job.make()  # a planner that cannot be is refused before there is a folder
    made = Pockets(cell, job, files.velocity, SimulatedBench(options.paced))
    folder = create(run_path(data, options.run), FORCE, cell, made, files.take_into, sorted(options.accept))
    title = f"{wanted:g} N wanted"
    return ExperimentProcedure(FORCE, title, folder, made, _View(made), desk, is_paced=options.paced)


class _View:
    """What is seen of the pockets."""

    def __init__(self, made: Pockets) -> None:
        self._made, self._motion, self.sources = made, Motion(made.first.cell), SOURCES

    def gauges(self, watch: Watch) -> Iterator[Gauge]:
        """Give where the tool is, how fast the joints turn, the force, and what is believed of the material."""
        yield from cutting(watch, self._made.cell.force)
        yield from self._motion.gauges(watch)
        yield from timed(watch)

    def lately(self, watch: Watch) -> Iterator[tuple[str, Panel]]:
        """Draw the last seconds."""
        return lately(watch, self._made.cell.force.force)

    def after(self, part: str, path: Path) -> Mapping[str, Panel]:  # noqa: ARG002 (all are drawn)
        """Return the tables of the pockets so far."""
        return tables(self._made.kept(records_of(path)))
