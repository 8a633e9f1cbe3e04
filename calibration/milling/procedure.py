"""The calibration of milling as the daemon begins it: the same as `calibrate milling`, told to a desk."""

from pathlib import Path

from calibration.milling.report import FIT_HEAD, fit_rows, milling_report
from calibration.milling.session import CHIRPS, calibrate, output_of, raw_trials, refuse_unfit_path, require_room
from calibration.milling.sweep_session import sweep, sweep_steps
from calibration.output import Wish
from ctlblocks.recording import Recording
from rigkit.experiment.procedure import strips_of
from rigkit.experiment.runner import Conduct
from rigkit.experiment.strips import PERIOD, strip
from rigkit.experiment.watch import WINDOW
from rigkit.run_folder import RunFolder
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Gauge, Table
from stagectl.daemon.cell.options import MillingOptions
from stagectl.daemon.cell.trial_runner import TrialRunner
from stagectl.daemon.cell_gauges import Motion, timed
from stagectl.daemon.conductor import Conductor
from stagectl.experiments.trials.campaign import FREE
from stagectl.experiments.trials.daemon import ON_TOOL, SOURCES
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.panels import along, errors, path
from stagectl.experiments.trials.surroundings import refuse_wrong_plants
from stagectl.experiments.trials.trial import cell_for_task, first_trial
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import write_milling
from stagectl.robot.milling.torque_file import UNITS

SWEPT = {"reference": "sweep.reference", "torque": "robot.torque"}
"""What is seen of the sweep."""


class MillingProcedure:
    """One calibration of milling under the daemon; one that was stopped goes on from what it had recorded.

    Parameters
    ----------
    config : CellConfig
    options : MillingOptions
    desk : Desk

    Raises
    ------
    ValueError : a path out of reach, or too fast or too short for the models, plants that do not take their options, or
        a model that is something else's.
    """

    def __init__(self, config: CellConfig, options: MillingOptions, desk: Desk) -> None:
        self._desk, self._task = desk, options.task
        self._cell = cell_for_task(config, options.task)
        self._out = Path(config.daemon.data) / options.model
        first = first_trial(self._cell, options.task)
        refuse_wrong_plants(first)
        refuse_unfit_path(self._cell, first)
        wish = Wish(options.again, options.recompute, options.accept)
        self._writes = output_of(self._out, self._cell, wish)
        if not options.recompute:
            require_room(self._out, self._cell, options.task)
        self._steps, self._moves = [step.words for step in sweep_steps(self._cell)], 0
        self._conductor = Conductor(desk, SOURCES, options.paced)
        self._sweeping = Conductor(desk, SWEPT, options.paced)
        self._motion, self._total = Motion(self._cell), 4 + config.learning.free
        self._trials: TrialRunner | None = None
        self._first = first
        self._free: list[DoneTrial] = []

    def stop(self) -> None:
        """Lift the tool out of the material; in the sweep, hold the arm."""
        self._sweeping.stop()
        self._conductor.stop()

    def gauges(self) -> list[Gauge]:
        """Return where the tool is, how fast the joints turn, when it was seen, and the force on it."""
        swept = self._sweeping.watch
        if self._trials is not None:
            return self._trials.gauges()
        return [*self._motion.gauges(swept), *timed(swept)]

    def run(self) -> None:
        """Measure, fit, and write the models and their report.

        Raises
        ------
        Stopped : the desk said that it is to end.
        PartEnded : a fault.
        """
        desk, total = self._desk, self._total
        desk.progress(0, total, "getting ready")
        for note in self._writes.notes:
            desk.event("note", {"text": note})
        with raw_trials(self._writes) as folder, Regularly(self._draw, PERIOD):
            swept = self._swept(folder)
            self._trials = TrialRunner(self._conductor, folder, self._first.cell, 1, total, self._show)
            found = calibrate(self._cell, self._task, self._trials, swept, self._writes.provenance)
        for note in found.notes:
            desk.event("note", {"text": note})
        desk.progress(total, total, "writing models and report")
        write_milling(self._out, found.models, UNITS)
        self._writes.finish()
        milling_report(found, str(self._out)).write(self._out.with_suffix(".html"))
        desk.show("fits", Table("Fits on validation data, %", FIT_HEAD, tuple(fit_rows(found))))
        desk.event("calibrated", {"model": self._out.name, "fits": {row[0]: row[1:] for row in fit_rows(found)}})

    def _swept(self, folder: RunFolder) -> Recording:
        def tell(text: str) -> None:
            self._moves += 1
            words = f"sweep, motion {self._moves}: {text.strip()}"
            self._desk.progress(self._moves / len(self._steps), self._total, words)

        self._desk.recording(True)
        try:
            return sweep(self._cell, False, folder, tell, Conduct(self._sweeping.ending, self._sweeping.watch))
        finally:
            self._desk.recording(False)
            self._sweeping.watch.forget()

    def _show(self, done: DoneTrial) -> None:
        self._desk.show("error", along(done))
        if done.name == CHIRPS:
            return
        self._desk.show("path", path(done))
        if done.name.startswith(FREE) and done.trial.zero is not None:
            self._free.append(done)
            self._desk.show("free_space", errors("Free space", dict(enumerate(self._free, start=1))))

    def _draw(self) -> None:
        for name, panel in strips_of(self._conductor.watch, (ON_TOOL,)):
            self._desk.show(name, panel)
        time, torque = self._sweeping.watch.lately("torque")
        if len(time):
            names = tuple(f"joint {joint}" for joint in range(1, 7))
            self._desk.show("torque", strip(f"Torques, last {WINDOW:g} s", Axis("torque", "N m"), time, torque, names))
