"""A trial on the robot behind its wires: to its start, along its path in the same graph as simulated, and out again."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from ctlblocks import Graph
from ctlblocks.recording import Recording
from rigkit.priority import real_time, undisturbed
from rigkit.provenance import now, software
from stagectl.devices.signals import ROBOT, TRACKER, Sources
from stagectl.robot.config import CellConfig
from stagectl.robot.live.blocks import LiveForce, LiveReference, LiveRobot, LiveTracker
from stagectl.robot.live.guide import Guide
from stagectl.robot.live.person import Person
from stagectl.robot.live.torque_log import TorqueLog
from stagectl.robot.live.way import room_of
from stagectl.robot.live.wires import LiveWires
from stagectl.trials.conduct import Conduct, Milled
from stagectl.trials.led import led
from stagectl.trials.recorded import FORCE, RECORDED, SLOW, TORQUE
from stagectl.trials.run import run
from stagectl.trials.session import Perform, run_simulated
from stagectl.trials.signals import NO_TORQUES
from stagectl.trials.surroundings import Surroundings
from stagectl.trials.tool_path import RATE
from stagectl.trials.trial import Trial, tool_arm

KEPT = ("trial", "tracker")
"""Recordings of a live trial; nobody knows the truth."""


class LiveTrials:
    """Runs trial after trial on a robot: `session.Runner`'s `perform`.

    Before each a person confirms that the block is in its place, or none.  One that a fault has ended leaves the tool
    lifted out, or the robot held.

    Parameters
    ----------
    cell : CellConfig
        Its limits hold on the way to a trial; in a trial, those of the trial.
    person : Person
    clock : callable() -> float, s, monotonic
    """

    def __init__(self, cell: CellConfig, person: Person, clock: Callable[[], float] = time.monotonic) -> None:
        self._cell, self._guide = cell, Guide(cell, person, clock)

    def __call__(self, trial: Trial, conduct: Conduct) -> Milled:
        """Run a trial.

        Raises
        ------
        ValueError, LinkError, Stopped : as of `Guide.bring`, before the trial begins.
        """
        block = "a fresh block in its place, the spindle on" if trial.is_milled else "no block under the tool"
        what = f"trial {trial.number}, {trial.path.samples / RATE:.0f} s: {block}, nobody in the cell"
        room = room_of(self._cell, trial.arm, float(trial.path.origin(trial.arm)[2]))
        self._guide.bring(what, trial.is_milled, room, trial.joints[0], conduct.tell, conduct.stopped)
        came = self._run(trial, conduct)
        if not came.reason:
            self._guide.finished(room)
        return came

    def leave(self, conduct: Conduct) -> None:
        """Go up from where the last trial has ended, if it came to its end."""
        self._guide.leave(conduct.tell, conduct.stopped)

    def _run(self, trial: Trial, conduct: Conduct) -> Milled:
        about = {"trial": str(trial.number), "date": now(), "software": software(), "cell": "live"}
        log, signals = TorqueLog(trial.path.samples), {name: RECORDED[name] for name in KEPT}
        with undisturbed(), real_time(), LiveWires(trial.cell, conduct.tell, True, self._guide.clock) as wires:
            came = run(trial, led(conduct, wires, SLOW), live(wires, log), signals, about)
            reason = wires.port.reason or came.reason
        own = _with_torques(came.recordings["trial"], log, wires.begun, trial.cell.learning.gap)
        return Milled(came.recordings | {"trial": own}, reason, came.figures)


@contextmanager
def performing(cell: CellConfig, person: Person | None, conduct: Conduct) -> Iterator[Perform]:
    """Give what runs a trial; a robot whose last one came to its end goes up in the end.

    Parameters
    ----------
    cell : CellConfig
    person : Person or None
        Beside the robot; None for the simulated cell.
    conduct : Conduct
    """
    if person is None:
        yield run_simulated
        return
    trials = LiveTrials(cell, person)
    yield trials
    trials.leave(conduct)


def live(wires: LiveWires, log: TorqueLog) -> Surroundings:
    """Return what adds the robot, tracker and force sensor behind their wires.

    Parameters
    ----------
    wires : LiveWires
    log : TorqueLog
    """

    def surround(graph: Graph, _: Trial) -> Sources:
        graph.add("robot", LiveRobot(wires, log), SLOW)
        graph.add("camera", LiveTracker(wires))
        graph.add("sensor", LiveForce(wires.records), SLOW)
        graph.add("sent", LiveReference(wires.port), SLOW)
        graph.connect("port.reference", "sent.reference")
        sources = {signal.name: (f"robot.{signal.name}", False) for signal in (*ROBOT, TORQUE)}
        sources |= {signal.name: (f"camera.{signal.name}", False) for signal in TRACKER}
        felt = zip(FORCE, ("measured", "sample", "status"), strict=True)
        return sources | {signal.name: (f"sensor.{port}", False) for signal, port in felt}

    return surround


def steps(cell: CellConfig, first: Trial, trials: int) -> list[str]:
    """Return in words all that moves in live trials, in order.

    Parameters
    ----------
    cell : CellConfig
    first : Trial
    trials : int
        In material.
    """
    path = first.path
    lowest, highest = (1e3 * each(path.wanted, axis=0) for each in (np.min, np.max))
    changes = "the robot's program changes the blocks" if cell.robot.changer else "a person changes the blocks"
    before, after = ways(cell, first)
    return [
        before,
        f"{cell.learning.free + 1} trials in the air, x {lowest[0]:.0f} to {highest[0]:.0f}, y {lowest[1]:.0f} to "
        f"{highest[1]:.0f}, z {lowest[2]:.0f} to {highest[2]:.0f} mm in the workpiece, and up to "
        f"{1e3 * cell.learning.correction:g} mm beside that: {path.samples / RATE:.1f} s each, no block under the tool",
        f"{trials} trials in material, {1e3 * path.pocket.depth:g} mm deep: {path.samples / RATE:.1f} s each, a fresh "
        f"block each; {changes}",
        after,
    ]


def ways(cell: CellConfig, first: Trial) -> tuple[str, str]:
    """Return in words how the tool comes to a live trial, and away from it.

    Parameters
    ----------
    cell : CellConfig
    first : Trial
    """
    robot, path = cell.robot, first.path
    origin = path.origin(tool_arm(cell))
    up = f"straight up to {1e3 * robot.height:g} mm over the surface"
    return (
        f"before each trial: {up}, z = {1e3 * origin[2]:.1f} mm in the base, across to x = {1e3 * origin[0]:.1f}, y = "
        f"{1e3 * origin[1]:.1f} mm, down to {1e3 * path.pocket.clearance:g} mm over it; at most "
        f"{1e3 * robot.travel:g} mm/s",
        f"after each trial: {up}",
    )


def _with_torques(own: Recording, log: TorqueLog, begun: float, gap: float) -> Recording:
    """Return the recording with the torques as they were at its samples; or that there are none, and why."""
    names = TORQUE.channels
    data, about = own.data.copy(), dict(own.provenance)
    place = [own.names.index(name) for name in names]
    try:
        data[:, place] = log.torques(begun, len(data), gap)
    except ValueError as fault:
        data[:, place] = 0.0
        about[NO_TORQUES] = str(fault)
    return Recording(own.names, own.units, own.rate, data, about)
