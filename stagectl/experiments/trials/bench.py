"""Where a trial is run: one that is simulated here, `wired` has the robot behind its wires."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol

from rigkit.experiment.part import Part
from stagectl.experiments.trials.surroundings import simulated
from stagectl.experiments.trials.trial import Trial
from stagectl.experiments.trials.trial_graph import TrialGraph
from stagectl.link.tell import Tell

Stopped = Callable[[], bool]


class Bench(Protocol):
    """What trials are run on, one after another."""

    def part(self, name: str, trial: Trial, tell: Tell, stopped: Stopped) -> AbstractContextManager[Part]:
        """Give a trial to be run, its devices open.

        Parameters
        ----------
        name : str
        trial : Trial
        tell : callable(event, fields)
            Told of faults and retreats.
        stopped : callable() -> bool
            Asked while the devices are got ready.
        """

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Leave the machine, after the last trial."""


class SimulatedBench:
    """The simulated cell: each trial has a machine of its own."""

    @contextmanager
    def part(self, name: str, trial: Trial, tell: Tell, stopped: Stopped) -> Iterator[Part]:  # noqa: ARG002
        """Give a trial to be run."""
        yield TrialGraph(name, trial, tell, simulated).part()

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Leave nothing."""
