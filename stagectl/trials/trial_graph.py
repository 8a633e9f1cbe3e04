"""The graph of a trial: robot, tracker and cut at 2 kHz, path and port at 250 Hz."""

from dataclasses import asdict
from typing import Any

from ctlblocks import Graph
from ctlblocks.replay import Record
from stagectl.devices.signals import ROBOT, TRACKER, Signal
from stagectl.link.tell import Tell
from stagectl.robot.wired_force import WiredForce
from stagectl.robot.wired_port import WiredPort
from stagectl.robot.wired_tracker import WiredTracker
from stagectl.trials.recorded import EVERY, FORCE, RATE, SLOW
from stagectl.trials.surroundings import Surroundings
from stagectl.trials.tool_path import RATE as PATH_RATE
from stagectl.trials.trial import Trial
from stagectl.trials.trial_path import TrialPath

assert RATE == SLOW * PATH_RATE


class TrialGraph:
    """A trial in a graph of one sample a tick.

    Parameters
    ----------
    trial : Trial
    tell : callable(event, fields)
        Told of faults and retreats.
    surroundings : Surroundings
    recorded : dict of str to tuple of Signal
        What is recorded, by the name of the recording.
    """

    def __init__(
        self, trial: Trial, tell: Tell, surroundings: Surroundings, recorded: dict[str, tuple[Signal, ...]]
    ) -> None:
        self.trial, self.graph = trial, Graph(RATE)
        path, pocket = trial.path, trial.cell.pocket
        nominal, raised = (path.joints(trial.arm, each) for each in (path.wanted, path.raised()))
        self.path = TrialPath(nominal, trial.joints - nominal, raised, pocket.retreat, path.moves, tell)
        self.port = WiredPort(trial.cell, trial.joints[0], tell)
        self.seen = WiredTracker(trial.cell.tracker, self.path.retreat)
        self.graph.add("path", self.path, SLOW)
        self.graph.add("port", self.port, SLOW)
        self.graph.add("seen", self.seen)
        self.felt = WiredForce(trial.cell.force_sensor, self.path.retreat)
        self.graph.add("felt", self.felt)
        self.graph.connect("path.resting", "felt.resting")
        self._sources = dict(surroundings(self.graph, trial))
        for name in ("nominal", "correction"):
            self.graph.connect(f"path.{name}", f"port.{name}")
        for block, signals in (("port", ROBOT), ("seen", TRACKER)):
            for signal in signals:
                self._wire(signal.name, f"{block}.{signal.name}")
        for signal, port in zip(FORCE, ("measured", "sample", "status"), strict=True):
            self._wire(signal.name, f"felt.{port}")
        self.records = {name: self._record(name, signals) for name, signals in recorded.items()}
        self.graph.prepare()

    @property
    def total(self) -> int:
        """Ticks of a trial that nothing ends early."""
        return self.trial.path.samples * SLOW

    @property
    def reason(self) -> str:
        """Why it ended early, or nothing."""
        return self.port.reason or self.path.reason

    def follow(self) -> None:
        """Let the robot follow its path, and tracker and force sensor be watched (between ticks); a fault latches."""
        self.port.start()
        self.seen.start()
        self.felt.start()

    def figures(self) -> dict[str, Any]:
        """Return what the blocks have counted."""
        return {"tracker": asdict(self.seen.counts[1]), "force": asdict(self.felt.counts)}

    def _record(self, name: str, signals: tuple[Signal, ...]) -> Record:
        made = Record([each.port for each in signals], self.total // EVERY[name])
        self.graph.add(f"record_{name}", made, EVERY[name])
        for each in signals:
            self._wire(each.source, f"record_{name}.{each.name}")
        return made

    def _wire(self, source: str, target: str) -> None:
        output, delayed = self._sources.get(source, (source, False))
        self.graph.connect(output, target, delayed=delayed)
