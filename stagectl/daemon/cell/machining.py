"""The procedure that mills the toroid in steel: robot alone, with a tracker, with the stage."""

from pathlib import Path
from typing import Any

from rigkit.disk_space import require
from rigkit.experiment.strips import PERIOD
from rigkit.service.paths import data_file, run_path
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge
from rigkit.stop import Stopped
from stagectl.daemon.cell.conductor import Conductor
from stagectl.daemon.cell.gauges import REFERENCE, Motion, sighted, timed
from stagectl.daemon.cell.machining_panels import MachiningPanels, near
from stagectl.daemon.cell.options import CellOptions
from stagectl.machining import session
from stagectl.machining.plan import AXES, RATE, SETUPS, Plan, designs_of, plan, stage_of
from stagectl.machining.report import cell_report
from stagectl.machining.surroundings import refuse_wrong_plants
from stagectl.robot.config import CellConfig

SOURCES = {**REFERENCE, "age": "seen.age", "deviation": "relative.deviation", "travel": "travel.reference"}


class Machining:
    """Setups of the toroid, one after another, under the daemon.

    Parameters
    ----------
    config : CellConfig
    options : CellOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : there is no such setup or stage, models do not fit, or there is no room; no folder is made.
    """

    def __init__(self, config: CellConfig, options: CellOptions, desk: Desk) -> None:
        self._conductor, self._desk = Conductor(desk, SOURCES, options.paced), desk
        desk.progress(0, 1, "getting ready")
        data = Path(config.daemon.data)
        setups = list(SETUPS) if options.setup == "all" else [options.setup]
        models = [data / f"stage-{axis}.h5" for axis in AXES]
        stage = stage_of(data_file(config.daemon.data, "stage", options.stage) if options.stage else None)
        files = session.Files(config, stage, models if all(model.is_file() for model in models) else ())
        for note in session.refuse_foreign_models(files, options.accept):
            desk.event("note", {"text": note})
        has_stage = any(each.startswith("C") for each in setups)
        designs = designs_of(stage, files.models) if has_stage else []
        self._plans = [plan(each, config, stage, designs) for each in setups]
        for made in self._plans:
            refuse_wrong_plants(made)
        path = run_path(config.daemon.data, options.run)
        require(path, sum(map(session.room, self._plans)), f"{len(self._plans)} of the setups")
        self._motion = Motion(self._plans[0].cell)
        self._made = self._plans[0]
        self._panels = MachiningPanels(desk, self._conductor.watch)
        self._folder = session.create(path, files, options.accept)

    def stop(self) -> None:
        """Hold the robot where it is: within `limits.stop`."""
        self._conductor.stop()

    def gauges(self) -> list[Gauge]:
        """Return where the tool is in the workpiece and on its stage, where the robot is, and when it was seen."""
        watch, cell = self._conductor.watch, self._made.cell
        return [*self._motion.gauges(watch), *near(watch, self._made), *sighted(watch, cell), *timed(watch)]

    def run(self) -> None:
        """Mill all setups and write the report.

        Raises
        ------
        Stopped : the desk said that it is to end.
        ValueError : the robot was held, by its reason.
        """
        with self._folder as folder:
            with Regularly(self._panels.draw, PERIOD):
                rows = [self._mill(number, made) for number, made in enumerate(self._plans)]
            self._desk.progress(len(self._plans), len(self._plans), "writing the report")
            cell_report(folder.path)
            self._desk.event("finished", {"run": folder.path.name, "setups": [row["setup"] for row in rows]})

    def _mill(self, number: int, made: Plan) -> dict[str, Any]:
        self._conductor.between({"before": made.setup})
        self._made, total = made, made.path.seconds

        def show(ticks: int) -> None:
            where = f"setup {made.setup}, {ticks / RATE:.0f} of {total:.0f} s"
            self._desk.progress(number + ticks / RATE / total, len(self._plans), where)

        self._desk.recording(True)
        try:
            row = session.run(self._folder, made, self._conductor.conduct(self._folder, self._conductor.ending, show))
        finally:
            self._desk.recording(False)
            self._conductor.watch.forget()
        self._panels.keep(row)
        if row["fault"]:
            if self._conductor.ending():
                raise Stopped(f"setup {made.setup}: {row['fault']}; what is recorded is kept")
            raise ValueError(f"setup {made.setup}: {row['fault']}")
        return row
