"""Trials on the robot behind its wires: to each one's start, along its path in the same graph as simulated, and out."""

import time
from collections.abc import Callable
from contextlib import AbstractContextManager

from ctlblocks import Graph
from rigkit.experiment.part import Part
from stagectl.devices.signals import ROBOT, TRACKER, Sources
from stagectl.experiments.trials.bench import Bench, SimulatedBench, Stopped
from stagectl.experiments.trials.recorded import FORCE, LOGGED, SLOW, TORQUE
from stagectl.experiments.trials.surroundings import Surroundings
from stagectl.experiments.trials.trial import Trial
from stagectl.experiments.trials.trial_graph import TrialGraph
from stagectl.link.tell import Tell
from stagectl.robot.config import CellConfig
from stagectl.robot.live.blocks import LiveForce, LiveReference, LiveRobot, LiveTorques, LiveTracker
from stagectl.robot.live.led import LedRobot, Work
from stagectl.robot.live.person import Person
from stagectl.robot.live.way import room_of
from stagectl.robot.live.wires import LiveWires


class WiredBench:
    """A robot with tracker and force sensor, and a person beside it: as of `LedRobot`."""

    def __init__(self, cell: CellConfig, person: Person, clock: Callable[[], float] = time.monotonic) -> None:
        self._robot = LedRobot(cell, person, clock)

    def part(self, name: str, trial: Trial, tell: Tell, stopped: Stopped) -> AbstractContextManager[Part]:
        """Bring the tool to where a trial begins, and give that, its wires open: as of `LedRobot.part`."""
        block = "a fresh block in its place, the spindle on" if trial.is_milled else "no block under the tool"
        what = f"trial {trial.number}, {trial.path.seconds:.0f} s: {block}, nobody in the cell"
        room = room_of(self._robot.cell, trial.arm, float(trial.path.origin(trial.arm)[2]))

        def make(wires: LiveWires, told: Tell) -> Part:
            return TrialGraph(name, trial, told, wired(wires)).part()

        work = Work(what, trial.is_milled, trial.cell, room, trial.joints[0], True, make)
        return self._robot.part(work, tell, stopped)

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Go up from where the last trial has ended, if it came to its end."""
        self._robot.leave(tell, stopped)


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
