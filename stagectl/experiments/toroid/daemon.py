"""The toroid under the daemon: what is measured and drawn while it is milled."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from rigkit.experiment.kept import create, records_of
from rigkit.experiment.procedure import ExperimentProcedure, Strip, strips_of
from rigkit.experiment.watch import Watch
from rigkit.run_folder import read_events
from rigkit.service.paths import data_file, run_path
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge, Panel, Table
from stagectl.daemon.cell_gauges import REFERENCE, Motion, sighted, timed
from stagectl.devices.signals import AXES
from stagectl.experiments.toroid.event_text import reasons_of
from stagectl.experiments.toroid.experiment import Toroid
from stagectl.experiments.toroid.options import CellOptions
from stagectl.experiments.toroid.plan import stage_of
from stagectl.experiments.toroid.read_back import TOROID, Files, plans_of
from stagectl.experiments.toroid.report import HEAD, table_rows
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_unguided


def procedure(config: CellConfig, options: CellOptions, desk: Desk) -> ExperimentProcedure:
    """Return setups of the toroid, one after another.

    Parameters
    ----------
    config : CellConfig
    options : CellOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : there is no such setup or stage, models do not fit, or there is no room; live, it is to be
        paced, or nobody can begin to guide the robot; no folder is made.
    """
    options.refuse_live("live", options.live)
    if options.live:
        refuse_unguided(config)
    desk.progress(0, 1, "getting ready")
    data = config.daemon.data
    models = [Path(data) / f"stage-{axis}.h5" for axis in AXES]
    stage = stage_of(data_file(data, "stage", options.stage) if options.stage else None)
    files = Files(stage, models if all(model.is_file() for model in models) and not options.live else ())
    for note in files.refuse_foreign(options.accept):
        desk.event("note", {"text": note})
    made = Toroid(plans_of(options.setup, config, files, options.live))
    view, path, accept = _View(made), run_path(data, options.run), sorted(options.accept)
    folder = create(path, TOROID, config, made, files.take_into, accept)
    return ExperimentProcedure(TOROID, f"setup {options.setup}", folder, made, view, desk, is_paced=options.paced)


class _View:
    """What is seen of the setups."""

    def __init__(self, made: Toroid) -> None:
        self._made, idle = made, None if made.is_live else 0.0
        self._motion = Motion(made.plans[0].cell, idle)
        self._rows: list[dict[str, Any]] = []
        self.sources = {**REFERENCE, "age": "seen.age", "deviation": "relative.deviation", "travel": "travel.reference"}
        titles = {"deviation": "Tool off its path", "travel": "Stage, reference"}
        self._strips = [Strip(name, "m", (name,), AXES, title) for name, title in titles.items()]

    def gauges(self, watch: Watch) -> Iterator[Gauge]:
        """Give where the tool is in the workpiece and on its stage, where the robot is, and when it was seen."""
        plan = self._made.plans[0]
        yield from self._motion.gauges(watch)
        deviation, travel = watch.newest("deviation"), watch.newest("travel")
        if deviation is not None:
            for axis, value in zip(AXES, deviation.tolist(), strict=True):
                yield Gauge(f"deviation_{axis}", f"Tool off its path, {axis}", value, "m")
        if travel is not None:
            for axis, value in zip(AXES, travel.tolist(), strict=True):
                yield Gauge(f"travel_{axis}", f"Stage, travel {axis}", value, "m", *plan.stage.limits.travel)
        yield from sighted(watch, plan.cell)
        yield from timed(watch)

    def lately(self, watch: Watch) -> Iterator[tuple[str, Panel]]:
        """Draw the last seconds."""
        return strips_of(watch, self._strips)

    def after(self, part: str, path: Path) -> Mapping[str, Panel]:
        """Return the table of the setups so far."""
        alone = Toroid([plan for plan in self._made.plans if plan.setup == part], reasons_of(read_events(path)))
        self._rows += alone.figures(records_of(path, f"{part}-"))["setups"]
        return {"accuracy": Table("The toroid in steel, lengths in µm", HEAD, tuple(table_rows(self._rows)))}
