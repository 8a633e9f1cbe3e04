"""Trials on the robot behind its wires: to each one's start, along its path in the same graph as simulated, and out."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from ctlblocks import Graph
from rigkit.experiment.part import Part, Retreat
from rigkit.priority import real_time, undisturbed
from stagectl.devices.signals import ROBOT, TRACKER, Sources
from stagectl.link.tell import Tell
from stagectl.robot.config import CellConfig
from stagectl.robot.live.blocks import LiveForce, LiveReference, LiveRobot, LiveTorques, LiveTracker
from stagectl.robot.live.clock import ReportClock
from stagectl.robot.live.guide import Guide
from stagectl.robot.live.person import Person
from stagectl.robot.live.way import room_of
from stagectl.robot.live.wires import LiveWires
from stagectl.trials.bench import Bench, SimulatedBench, Stopped
from stagectl.trials.recorded import FORCE, LOGGED, SLOW, TORQUE
from stagectl.trials.surroundings import Surroundings
from stagectl.trials.tool_path import RATE
from stagectl.trials.trial import Trial
from stagectl.trials.trial_graph import TrialGraph


class WiredBench:
    """A robot with tracker and force sensor, and a person beside it.

    Before each trial a person confirms that the block is in its place, or none.  One that a fault has ended leaves the
    tool lifted out, or the robot held.

    Parameters
    ----------
    cell : CellConfig
        Its limits hold on the way to a trial; in a trial, those of the trial.
    person : Person
    clock : callable() -> float, s, monotonic
    """

    def __init__(self, cell: CellConfig, person: Person, clock: Callable[[], float] = time.monotonic) -> None:
        self._cell, self._guide = cell, Guide(cell, person, clock)

    @contextmanager
    def part(self, name: str, trial: Trial, tell: Tell, stopped: Stopped) -> Iterator[Part]:
        """Bring the tool to where a trial begins, and give that, its wires open.

        Raises
        ------
        ValueError, LinkError, Stopped : as of `Guide.bring`, before the trial begins.
        """
        block = "a fresh block in its place, the spindle on" if trial.is_milled else "no block under the tool"
        what = f"trial {trial.number}, {trial.path.samples / RATE:.0f} s: {block}, nobody in the cell"
        room = room_of(self._cell, trial.arm, float(trial.path.origin(trial.arm)[2]))
        self._guide.bring(what, trial.is_milled, room, trial.joints[0], tell, stopped)
        with undisturbed(), real_time(), LiveWires(trial.cell, tell, True, self._guide.clock) as wires:
            graph = TrialGraph(name, trial, wires.unless_told(tell), wired(wires))
            part = graph.part()
            assert part.retreat is not None
            retreat = _Held(part.retreat, wires).retreat
            yield replace(part, clock=ReportClock(wires, SLOW), retreat=retreat, rest=wires.port.stop)
            is_whole = not retreat.fault() and part.graph.ticks >= part.ticks
        if is_whole:
            self._guide.finished(room)

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Go up from where the last trial has ended, if it came to its end."""
        self._guide.leave(tell, stopped)


class _Held:
    """The retreat of a trial, which is none where the robot's wire has latched: then it is held where it is."""

    def __init__(self, within: Retreat, wires: LiveWires) -> None:
        self._within, self._port = within, wires.port

    @property
    def retreat(self) -> Retreat:
        return replace(self._within, fault=self._fault, begin=self._begin)

    def _fault(self) -> str:
        return self._port.reason or self._within.fault()

    def _begin(self, reason: str) -> None:
        if not self._port.reason:
            self._within.begin(reason)


def bench(cell: CellConfig, person: Person | None) -> Bench:
    """Return what trials are run on: the simulated cell where nobody is beside a robot."""
    return SimulatedBench() if person is None else WiredBench(cell, person)


def wired(wires: LiveWires) -> Surroundings:
    """Return what adds the robot, tracker, force sensor and the torques' line behind their wires.

    Parameters
    ----------
    wires : LiveWires
    """

    def surround(graph: Graph, _: Trial) -> Sources:
        graph.add("robot", LiveRobot(wires), SLOW)
        graph.add("camera", LiveTracker(wires))
        graph.add("torques", LiveTorques(wires))
        graph.add("sensor", LiveForce(wires.records), SLOW)
        graph.add("sent", LiveReference(wires.port), SLOW)
        graph.connect("port.reference", "sent.reference")
        sources = {signal.name: (f"robot.{signal.name}", False) for signal in (*ROBOT, TORQUE)}
        sources |= {signal.name: (f"camera.{signal.name}", False) for signal in TRACKER}
        sources |= {signal.name: (f"torques.{signal.name}", False) for signal in LOGGED}
        felt = zip(FORCE, ("measured", "sample", "status"), strict=True)
        return sources | {signal.name: (f"sensor.{port}", False) for signal, port in felt}

    return surround
