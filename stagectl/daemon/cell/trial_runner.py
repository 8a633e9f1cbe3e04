"""Trials of a procedure, one by one: each is run or read, told of, drawn, and may be waited for."""

from collections.abc import Callable

from rigkit.experiment.runner import Conduct
from rigkit.run_folder import RunFolder
from rigkit.service.show import Gauge
from stagectl.daemon.cell_gauges import Motion, milling
from stagectl.daemon.conductor import Conductor
from stagectl.experiments.trials.bench import SimulatedBench
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.runner import Runner
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.config import CellConfig


class TrialRunner:
    """Runs trials under a name; in the air between two of them it may be held or ended.

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
        self._name, self._seconds = "", 1.0
        self._cell, self._motion = cell, Motion(cell)
        watch = conductor.watch
        folder.listener = conductor.heard
        conduct = Conduct(conductor.stopped, watch, watch.look, self._show, self._between)
        self._runner = Runner(folder, SimulatedBench(), conduct, self._said)

    def __call__(self, name: str, trial: Trial) -> DoneTrial:
        """Run a trial, or read it where it is there already.

        Raises
        ------
        Stopped : the desk said that it is to end.
        PartEnded : a fault ended the trial; the tool has left the material, or the robot is held.
        """
        is_there = self._runner.has(name)
        if trial.cell is not self._cell:
            self._cell, self._motion = trial.cell, Motion(trial.cell)
        self._name, self._seconds = name, trial.path.seconds
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
        return list(milling(self._conductor.watch, self._motion, self._cell))

    def _between(self, name: str) -> None:
        self._conductor.between({"before": name})
        self._show(0.0)

    def _show(self, seconds: float) -> None:
        where = f"{self._name}, {seconds:.0f} of {self._seconds:.0f} s"
        self._desk.progress(self._done + seconds / self._seconds, self._total, where)

    def _said(self, text: str) -> None:
        name, _, told = text.partition(": ")
        self._desk.event("trial", {"trial": name, "told": told})
