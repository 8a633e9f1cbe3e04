"""What is asked of trials: a new run of them, or what is left of one."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from rigkit.experiment.kept import records_of
from rigkit.experiment.resumed import GoingOn
from stagectl.experiments.trials.bench import Bench, SimulatedBench
from stagectl.experiments.trials.done import BESIDE, done_trial
from stagectl.experiments.trials.experiment import Milling
from stagectl.experiments.trials.learner import learner_of
from stagectl.experiments.trials.read_back import JOINTS, MODEL, Files, task_of
from stagectl.experiments.trials.runner import trial_of
from stagectl.experiments.trials.surroundings import refuse_wrong_plants
from stagectl.experiments.trials.trial import first_trial
from stagectl.robot.config import CellConfig


def unheard(text: str) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class Asked:
    """Trials in the air, then in material by some methods.

    Parameters
    ----------
    methods : tuple of int
    iterations : int
        Trials in material after the first one, of each method.
    bench : Bench
    accept : collection of str
        Keys that may differ from what the models, or a run, were made with.
    note, say : callable(str)
        Told what differs; and a line of each trial.
    """

    methods: tuple[int, ...]
    iterations: int
    bench: Bench
    accept: Collection[str] = ()
    note: Callable[[str], object] = unheard
    say: Callable[[str], object] = unheard

    def new(self, cell: CellConfig, files: Files) -> Milling:
        """Return a new run.

        Parameters
        ----------
        cell : CellConfig
            As `cell_for_task` gives it.
        files : Files

        Raises
        ------
        ValueError : a path out of reach, models that do not fit, a law that may diverge, wrong options of plants.
        """
        return self._made(cell, files, ())

    def going_on(self, path: Path) -> GoingOn[Milling]:
        """Return how a run in a folder is gone on with.

        Parameters
        ----------
        path : Path
        """

        def make(done: Collection[str]) -> Milling:
            if any(path.glob(f"*-{BESIDE}.csv")):
                raise ValueError(f"{path}: is of version 0.1.0, must be begun again: it can be reported and replayed")
            cell, task = task_of(path)
            joints = path / JOINTS if (path / JOINTS).is_file() else None
            made = self._made(cell, Files(task, path / MODEL, joints), done, path)
            if not made.left:
                raise ValueError(f"{path}: nothing is left of it: {', '.join(made.names)} came to their end")
            return made

        return GoingOn(CellConfig, make, trial_of, self.accept, self.note)

    def _made(self, cell: CellConfig, files: Files, names: Collection[str], path: Path = Path()) -> Milling:
        first = first_trial(cell, files.task)
        learner = learner_of(cell, files.model, first, self.methods, self.accept, self.note, files.joints)
        for method in (None, *self.methods):
            learner.contraction(method).refuse_divergence()
        if isinstance(self.bench, SimulatedBench):
            refuse_wrong_plants(first)
        elif 3 in self.methods and not cell.robot.has_torques:
            raise ValueError("robot.signals is 0: method 3 needs the motors' torques, must be the port of their line")
        done = {name: done_trial(name, records_of(path, f"{name}-"), first) for name in sorted(names)}
        return Milling(first, self.methods, self.iterations, learner, self.bench, done, say=self.say)
