"""Trials of a procedure, one by one: each is run or read, told of, drawn, and may be waited for."""

from collections.abc import Callable

from rigkit.run_folder import RunFolder
from rigkit.service.show import Gauge
from stagectl.daemon.cell.conductor import Conductor
from stagectl.daemon.cell.gauges import REFERENCE, Motion, felt, sighted, timed
from stagectl.robot.config import CellConfig
from stagectl.trials.done import DoneTrial, has_trial
from stagectl.trials.recorded import RATE, SLOW
from stagectl.trials.session import Runner, run_simulated
from stagectl.trials.trial import Trial

SOURCES = {**REFERENCE, "age": "seen.age", "force": "felt.force", "valid": "felt.valid"}
"""What is seen of a trial."""


class TrialRunner:
    """Runs trials under a name, as `campaign.Run`; in the air between two of them it may be held or ended.

    Parameters
    ----------
    conductor : Conductor
    folder : RunFolder
    cell : CellConfig
        As of the first trial.
    before, total : int
        Steps of the procedure that are done before the first trial, and all of them.
    draw : callable(DoneTrial)
        Called with each trial that has come to its end.
    """

    def __init__(
        self,
        conductor: Conductor,
        folder: RunFolder,
        cell: CellConfig,
        before: int,
        total: int,
        draw: Callable[[DoneTrial], object],
    ) -> None:
        self._conductor, self._desk, self._folder = conductor, conductor.desk, folder
        self._done, self._total, self._draw = before, total, draw
        self._name, self._ticks = "", 1
        self._cell, self._motion = cell, Motion(cell)
        conduct = conductor.conduct(folder, conductor.stopped, self._show)
        self._runner = Runner(folder, conduct, run_simulated, self._said)

    def __call__(self, name: str, trial: Trial) -> DoneTrial:
        """Run a trial, or read it where it is there already.

        Raises
        ------
        Stopped : the desk said that it is to end.
        TrialEnded : a fault ended the trial; the tool has left the material, or the robot is held.
        """
        is_there = has_trial(self._folder.path, name)
        if trial.cell is not self._cell:
            self._cell, self._motion = trial.cell, Motion(trial.cell)
        self._name, self._ticks = name, trial.path.samples * SLOW
        if not is_there:
            self._conductor.between({"before": name})
            self._show(0)
        self._desk.recording(not is_there)
        try:
            done = self._runner(name, trial)
        finally:
            self._desk.recording(False)
            self._conductor.watch.forget()
        self._done += 1
        self._desk.progress(self._done, self._total, name)
        self._draw(done)
        return done

    def gauges(self) -> list[Gauge]:
        """Return where the tool is, how fast the joints turn, when it was seen, and the force on it."""
        cell, motion, watch = self._cell, self._motion, self._conductor.watch
        strongest = max(cell.force_sensor.range_force)
        return [*motion.gauges(watch), *sighted(watch, cell), *felt(watch, strongest), *timed(watch)]

    def _show(self, ticks: int) -> None:
        where = f"{self._name}, {ticks / RATE:.0f} of {self._ticks / RATE:.0f} s"
        self._desk.progress(self._done + ticks / self._ticks, self._total, where)

    def _said(self, text: str) -> None:
        name, _, told = text.partition(": ")
        self._desk.event("trial", {"trial": name, "told": told})
