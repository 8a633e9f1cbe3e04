"""Learning to mill under the daemon: what is measured and drawn while trials are run."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from rigkit.experiment.kept import create, records_of
from rigkit.experiment.procedure import ExperimentProcedure, Strip, strips_of
from rigkit.experiment.resumed import take_up
from rigkit.experiment.watch import Watch
from rigkit.service.paths import data_file, run_path
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge, Panel
from stagectl.daemon.cell_gauges import REFERENCE, Motion, milling
from stagectl.devices.signals import AXES
from stagectl.experiments.trials.asked import Asked
from stagectl.experiments.trials.bench import SimulatedBench
from stagectl.experiments.trials.done import done_trial
from stagectl.experiments.trials.experiment import Milling
from stagectl.experiments.trials.learner import wanted_methods
from stagectl.experiments.trials.options import IlcOptions
from stagectl.experiments.trials.panels import panels
from stagectl.experiments.trials.read_back import MODEL, TRIALS, Files, is_of_trials
from stagectl.experiments.trials.trial import cell_for_task
from stagectl.robot.config import CellConfig

TITLE = "learning to mill"
SOURCES = {**REFERENCE, "age": "seen.age", "force": "felt.force", "valid": "felt.valid"}
"""What is seen of a trial."""

ON_TOOL = Strip("force", "N", ("force",), AXES, "Force on the tool", valid="valid")


def procedure(config: CellConfig, options: IlcOptions, desk: Desk) -> ExperimentProcedure:
    """Return trials in the air, then in material; or those that are left of a run.

    Parameters
    ----------
    config : CellConfig
    options : IlcOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : methods, models and path do not fit, or there is no such run to go on with; nothing is made.
    """
    desk.progress(0, 1, "getting ready")
    path, data = run_path(config.daemon.data, options.run), config.daemon.data

    def note(text: str) -> None:
        desk.event("note", {"text": text})

    def say(text: str) -> None:
        name, _, told = text.partition(": ")
        desk.event("trial", {"trial": name, "told": told})

    methods, bench = wanted_methods(options.method), SimulatedBench()
    asked = Asked(methods, options.iterations, bench, options.accept, note, say)
    if options.resume:
        if not is_of_trials(path):
            raise ValueError(f"run is {options.run!r}, where no trials are in {path}/")
        folder, made = take_up(path, asked.going_on(path))
    else:
        joints = data_file(data, "joints", options.joints) if options.joints else None
        files = Files(options.task, data_file(data, "model", options.model), joints)
        cell = cell_for_task(config, files.task)
        made = asked.new(cell, files)
        folder = create(path, TRIALS, cell, made, files.take_into, sorted(options.accept))
    view = _View(made, path / MODEL)
    return ExperimentProcedure(TRIALS, TITLE, folder, made, view, desk, is_paced=options.paced, finishes=True)


class _View:
    """What is seen of the trials."""

    def __init__(self, made: Milling, model: Path) -> None:
        self._first, self._model = made.first, model
        self._motion, self._done = Motion(made.first.cell), made.done
        self.sources = SOURCES

    def gauges(self, watch: Watch) -> Iterator[Gauge]:
        """Give where the tool is, how fast the joints turn, when it was seen, and the force on it."""
        return milling(watch, self._motion, self._first.cell)

    def lately(self, watch: Watch) -> Iterator[tuple[str, Panel]]:
        """Draw the last seconds."""
        return strips_of(watch, (ON_TOOL,))

    def after(self, part: str, path: Path) -> Mapping[str, Panel]:
        """Return what is drawn of a trial that came to its end, and of all before."""
        done = done_trial(part, records_of(path, f"{part}-"), self._first)
        if len(done.records["trial"].data) < self._first.path.samples or done.left is not None:
            return {}
        self._done.append(done)
        return panels(self._done, self._model)
