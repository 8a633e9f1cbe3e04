"""The graph of a trial, robot, tracker and cut at 2 kHz, path and port at 250 Hz; and what happens in which order."""

from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import Any

from ctlblocks import Graph
from ctlblocks.taps import Tap
from rigkit.experiment.part import Part, Phase, Retreat, Track
from rigkit.experiment.runner import STOPPED
from stagectl.devices.signals import ROBOT, TRACKER, by_axis
from stagectl.experiments.trials.recorded import (
    EVERY,
    FOLLOW,
    FORCE,
    LOGGED,
    MADE,
    NOMINAL,
    RATE,
    SENT,
    SLOW,
    TORQUE,
    TRUTH,
)
from stagectl.experiments.trials.surroundings import Surroundings
from stagectl.experiments.trials.tool_path import RATE as PATH_RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.experiments.trials.trial_path import TrialPath
from stagectl.link.tell import Tell
from stagectl.robot.wired_force import WiredForce
from stagectl.robot.wired_port import AFTERWARDS, WiredPort
from stagectl.robot.wired_tracker import WiredTracker

assert RATE == SLOW * PATH_RATE
_FOLLOW = round(FOLLOW * RATE)
"""Tick from which on the robot follows."""


class TrialGraph:
    """A trial in a graph of one sample a tick, not prepared.

    A blind tracker or a force sensor at fault lifts the tool out of the material; a robot that is at fault itself is
    held where it is.

    Parameters
    ----------
    name : str
        Of its recordings.
    trial : Trial
    tell : callable(event, fields)
        Told of faults and retreats.
    surroundings : Surroundings
    """

    def __init__(self, name: str, trial: Trial, tell: Tell, surroundings: Surroundings) -> None:
        self.name, self.trial, self.graph = name, trial, Graph(RATE)
        path, pocket = trial.path, trial.cell.pocket
        nominal, raised = (path.joints(trial.arm, each) for each in (path.wanted, path.raised()))
        angles = nominal, trial.joints - nominal, raised
        self.path = TrialPath(trial.sent, *angles, pocket.retreat, path.moves, tell)
        self.port = WiredPort(trial.cell, trial.joints[0], tell)
        self.seen = WiredTracker(trial.cell.tracker, self.path.retreat)
        self.felt = WiredForce(trial.cell.force_sensor, self.path.retreat)
        self.graph.add("path", self.path, SLOW)
        self.graph.add("port", self.port, SLOW)
        self.graph.add("seen", self.seen)
        self.graph.add("felt", self.felt)
        self.graph.connect("path.resting", "felt.resting")
        self._sources = dict(surroundings(self.graph, trial))
        for word in ("nominal", "correction"):
            self.graph.connect(f"path.{word}", f"port.{word}")
        for block, signals in (("port", ROBOT), ("seen", TRACKER)):
            for signal in signals:
                self._wire(signal.name, f"{block}.{signal.name}")
        for signal, port in zip(FORCE, ("measured", "sample", "status"), strict=True):
            self._wire(signal.name, f"felt.{port}")

    def tracks(self) -> Iterator[Track]:
        """Give what is recorded: the truth where it is known, the torques' own line where there is one."""
        said = {"trial": (NOMINAL, SENT, *ROBOT, TORQUE), "tracker": (*TRACKER, *FORCE)}
        if LOGGED[0].source in self._sources:
            said["tracker"] += LOGGED
        if TRUTH[0].source in self._sources:
            said["truth"] = TRUTH
        for name, signals in said.items():
            made = MADE.get(name, ())
            taps = [Tap(each.name, *self._sources.get(each.source, (each.source, False))) for each in (*signals, *made)]
            own = frozenset(each.name for each in made)
            yield Track(f"{self.name}-{name}", tuple(taps), own, EVERY[name], by_axis)

    def part(self) -> Part:
        """Return the trial as it is run: what stops it lifts the tool out, and brings it to rest."""
        limits, pocket = self.trial.cell.limits, self.trial.cell.pocket
        left = round((pocket.retreat + limits.stop + AFTERWARDS) * RATE)
        return self._part({_FOLLOW: self._follow}, Retreat(self.fault, self._leave, left))

    def part_again(self, left: int | None) -> Part:
        """Return the trial as it was run.

        Parameters
        ----------
        left : int or None
            Tick from which on the tool retreats, if it did: one before the robot follows has kept it from that.  A
            fault that had it do so comes again before.
        """
        if left is None:
            return self._part({_FOLLOW: self._follow}, None)
        begins: dict[int, Callable[[], object]] = {left: lambda: self._leave(STOPPED)}
        return self._part(begins if left <= _FOLLOW else {_FOLLOW: self._follow, **begins}, None)

    def fault(self) -> str:
        """Return why it ended early, or nothing."""
        return self.port.reason or self.path.reason

    def _part(self, begins: dict[int, Callable[[], object]], retreat: Retreat | None) -> Part:
        total = self.trial.path.samples * SLOW
        edges = [*begins, total]
        phases = [Phase("rest", edges[0])]
        for (first, begin), last in zip(begins.items(), edges[1:], strict=True):
            phases.append(Phase("path", max(last - first, 0), begin))
        about = self.trial.about
        return Part(self.name, self.graph, tuple(self.tracks()), phases, None, retreat, self._counts, about=about)

    def _follow(self) -> None:
        """Let the robot follow its path, and tracker and force sensor be watched (between ticks); a fault latches."""
        self.port.start()
        self.seen.start()
        self.felt.start()

    def _leave(self, reason: str) -> None:
        """Lift the tool out of the material, unless the robot is held where it is."""
        if not self.port.reason:
            self.path.retreat(reason)

    def _counts(self) -> dict[str, Any]:
        return {"tracker": asdict(self.seen.counts[1]), "force": asdict(self.felt.counts)}

    def _wire(self, source: str, target: str) -> None:
        output, delayed = self._sources.get(source, (source, False))
        self.graph.connect(output, target, delayed=delayed)
