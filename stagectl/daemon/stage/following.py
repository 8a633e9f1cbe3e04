"""The procedure that follows: a run of the stage behind its link, or of the simulated one, paced."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from rigkit.experiment.kept import create
from rigkit.experiment.part import nothing
from rigkit.experiment.procedure import ExperimentProcedure
from rigkit.experiment.watch import Watch
from rigkit.faults import FaultTable
from rigkit.service.paths import run_path
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge, Panel
from stagectl.config import StageConfig
from stagectl.daemon.gauges import driven, motion, paced
from stagectl.daemon.options import FollowOptions, HoldOptions
from stagectl.daemon.stage.monitor import Monitor, seen_by_laser, tracked
from stagectl.daemon.stage.panels import panels
from stagectl.daemon.stage.ready import Ready
from stagectl.daemon.stage.spoiled import spoiled
from stagectl.experiments.piezo.cell import simulated
from stagectl.experiments.piezo.experiment import STAGE_RUN, StageRun
from stagectl.experiments.piezo.fit import refuse_unfit
from stagectl.experiments.piezo.setup import Setup


def following(
    ready: Ready, config: StageConfig, options: FollowOptions | HoldOptions, desk: Desk, faults: FaultTable | None
) -> ExperimentProcedure:
    """Return one run under the daemon.

    Parameters
    ----------
    ready : Ready
    config : StageConfig
        Settings of this run.
    options : FollowOptions or HoldOptions
    desk : Desk
    faults : FaultTable or None

    Raises
    ------
    ValueError, OSError : there is no such loop, the reference is none, or there is no room; no folder is made.
    """
    desk.progress(0.0, config.session.seconds, "designing the loops")
    made = ready.setup(config, options.accept)
    for text in made.said:
        desk.event("note", {"text": text})
    refuse_unfit(made)
    seen = None if faults is None else spoiled(simulated(config), faults, config)
    run = StageRun(made, ready.models, ready.lent, seen)
    monitor = Monitor(made, run.held)
    run.watching["monitor"] = monitor
    path, accept = run_path(config.daemon.data, options.run), sorted(options.accept)
    folder = create(path, STAGE_RUN, config, run, run.take_into, accept)
    view, halt = _View(made, monitor), nothing if ready.link is None else ready.link.halt
    is_paced = not config.session.live
    return ExperimentProcedure(STAGE_RUN, "following", folder, run, view, desk, is_paced=is_paced, halt=halt)


class _View:
    """What is seen of a run: how well it follows; of a simulated stage, where that is, and what drives it."""

    sources: Mapping[str, str] = {}

    def __init__(self, made: Setup, monitor: Monitor) -> None:
        self._made, self._monitor = made, monitor

    def gauges(self, watch: Watch) -> Iterator[Gauge]:
        """Give what is measured now."""
        config, monitor = self._made.config, self._monitor
        if not config.session.live:
            yield from motion(config, monitor.position, monitor.voltage)
        yield from tracked(config, monitor)
        yield from seen_by_laser(config, monitor)
        if not config.session.live:
            yield from driven(config, monitor.voltage)
        if watch.pace is not None:
            yield from paced(watch.pace)

    def lately(self, watch: Watch) -> Iterator[tuple[str, Panel]]:  # noqa: ARG002 (it looks at every sample itself)
        """Draw the last second."""
        return panels(self._monitor.error(), self._made)

    def after(self, part: str, path: Path) -> Mapping[str, Panel]:  # noqa: ARG002 (a view's arguments)
        """Return nothing."""
        return {}
