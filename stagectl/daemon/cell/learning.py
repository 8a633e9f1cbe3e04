"""The procedure that learns to mill: trials in the air, then in material, with a pause between any two."""

from collections.abc import Collection
from typing import Any

from rigkit import config as rig_file
from rigkit.agreement import together
from rigkit.disk_space import require
from rigkit.experiment.strips import PERIOD
from rigkit.run_folder import CONFIG, RunFolder
from rigkit.run_origin import going_on
from rigkit.service.paths import data_file, run_path
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge
from stagectl.daemon.cell.conductor import Conductor
from stagectl.daemon.cell.learning_panels import LearningPanels
from stagectl.daemon.cell.options import IlcOptions
from stagectl.daemon.cell.strips import force_strip
from stagectl.daemon.cell.trial_runner import SOURCES, TrialRunner
from stagectl.robot.config import CellConfig
from stagectl.trials.campaign import FIRST, learn_free_space, learn_pocket
from stagectl.trials.command import learner_of, wanted_methods
from stagectl.trials.done import DoneTrial
from stagectl.trials.job import LOGS, report_again
from stagectl.trials.log_folder import write_logs
from stagectl.trials.session import LEARNING, MODEL, create, is_of_trials, room
from stagectl.trials.surroundings import refuse_wrong_plants
from stagectl.trials.trial import cell_for_task, first_trial


class Learning:
    """A campaign of trials under the daemon.

    Parameters
    ----------
    config : CellConfig
    options : IlcOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : methods, models and path do not fit, or there is no such run to go on with; nothing is made.
    """

    def __init__(self, config: CellConfig, options: IlcOptions, desk: Desk) -> None:
        self._conductor, self._desk = Conductor(desk, SOURCES, options.paced), desk
        self._methods, self._iterations = wanted_methods(options.method), options.iterations
        desk.progress(0, self._total(config), "getting ready")
        path = run_path(config.daemon.data, options.run)
        task: str = options.task
        if options.resume:
            if not is_of_trials(path):
                raise ValueError(f"run is {options.run!r}, where no trials are in {path}/")
            config = rig_file.load(path / CONFIG, CellConfig)
            task, model = (path / LEARNING).read_text(encoding="utf-8").strip(), path / MODEL
        else:
            model = data_file(config.daemon.data, "model", options.model)
        cell = cell_for_task(config, task)
        self._first = first_trial(cell, task)
        notes: list[str] = []
        self._learner = learner_of(cell, model, self._first, self._methods, options.accept, notes.append)
        for each in (None, *self._methods):
            self._learner.contraction(each).refuse_divergence()
        refuse_wrong_plants(self._first)
        self._whole = self._total(cell)
        require(path, room(self._first, self._whole), f"{self._whole:g} trials")
        self._panels = LearningPanels(desk, model, self._learner)
        if options.resume:
            self._folder = RunFolder.open(path)
            notes = together(notes, self._go_on(options.accept))
        else:
            self._folder = create(path, cell, task, model, options.accept)
        for text in notes:
            desk.event("note", {"text": text})
        self._trials = TrialRunner(self._conductor, self._folder, self._first.cell, 0, self._whole, self._keep)

    def _go_on(self, accept: Collection[str]) -> list[str]:
        """Refuse trials of which settings or models have changed since they began; return what is to be said."""
        path = self._folder.path
        try:
            return going_on(self._folder, rig_file.load(path / CONFIG, CellConfig, as_written=True), accept)
        except BaseException:
            self._folder.close()
            raise

    def stop(self) -> None:
        """Lift the tool out of the material, and hold."""
        self._conductor.stop()

    def gauges(self) -> list[Gauge]:
        """Return where the tool is, how fast the joints turn, when it was seen, and the force on it."""
        return self._trials.gauges()

    def run(self) -> None:
        """Run all trials and write the report; those that are there are read.

        Raises
        ------
        Stopped : the desk said that it is to end.
        TrialEnded : a fault ended a trial; the tool has left the material, or the robot is held.
        """
        with self._folder as folder:
            with Regularly(self._draw, PERIOD):
                self._learn()
            self._desk.progress(self._whole, self._whole, "writing the report")
            found = report_again(folder.path)
            folder.summarise(found)
            self._desk.event("finished", {"run": folder.path.name, "norms": _norms(found)})

    def _learn(self) -> None:
        run = self._trials
        milled = run(FIRST, learn_free_space(self._first, self._learner, run))
        for method in self._methods:
            learn_pocket(milled, self._learner, method, self._iterations, run)

    def _keep(self, done: DoneTrial) -> None:
        write_logs(self._folder.path / LOGS / done.name, done)
        self._panels.draw(done)

    def _draw(self) -> None:
        strip = force_strip(self._conductor.watch)
        if strip is not None:
            self._desk.show("force", strip)

    def _total(self, cell: CellConfig) -> int:
        """Return the number of trials: in the air, the first in material, and those that are learned."""
        return cell.learning.free + 2 + len(self._methods) * self._iterations


def _norms(found: dict[str, Any]) -> dict[str, list[float]]:
    """Return the norms of the errors of each method's trials, m."""
    return {method: [each["norm"] for each in done] for method, done in found["methods"].items()}
