"""Pieces of work on a guided robot, one after another: a person asked, brought there, led by its reports, and away."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from ctlblocks.clock import Clock
from rigkit.experiment.part import Part, Retreat
from rigkit.priority import real_time, undisturbed
from stagectl.link.tell import Tell
from stagectl.robot.config import CellConfig
from stagectl.robot.live.clock import ReportClock
from stagectl.robot.live.guide import Guide
from stagectl.robot.live.person import Person
from stagectl.robot.live.way import Room
from stagectl.robot.live.wires import LiveWires
from stagectl.robot.port import RobotPort
from stagectl.wire.robot import RATE


@dataclass(frozen=True, eq=False)
class Work:
    """A piece of work.

    Parameters
    ----------
    what : str
        That comes, and what is to be in place.
    has_block : bool
        Whether there is to be a block.
    cell : CellConfig
        With the limits of the work.
    room : Room
        With the limits on the way there.
    goal : array, shape (6,), rad
        Where it begins.
    tracks : bool
        Whether tracker and torque signals are listened to.
    make : callable(LiveWires, Tell) -> Part
        Makes it, its graph with what is behind the wires, and told of faults.
    feels : bool
        Whether the force sensor is listened to, and the torque signals where `tracks`.
    """

    what: str
    has_block: bool
    cell: CellConfig
    room: Room
    goal: np.ndarray
    tracks: bool
    make: Callable[[LiveWires, Tell], Part]
    feels: bool = True


class LedRobot:
    """A robot behind its wires, and a person beside it.

    Before each piece of work a person confirms what is in place.  One that a fault has ended leaves the tool where its
    retreat has brought it, or the robot held.

    Parameters
    ----------
    cell : CellConfig
        Its limits hold on the way to work.
    person : Person
    clock : callable() -> float, s, monotonic
    """

    def __init__(self, cell: CellConfig, person: Person, clock: Callable[[], float] = time.monotonic) -> None:
        self.cell, self._guide = cell, Guide(cell, person, clock)

    @contextmanager
    def part(self, work: Work, tell: Tell, stopped: Callable[[], bool]) -> Iterator[Part]:
        """Bring the tool to where work begins, and give that, its wires open and its clock the robot's reports.

        Raises
        ------
        ValueError, LinkError, Stopped : as of `Guide.bring`, before it begins.
        """
        self._guide.bring(work.what, work.has_block, work.room, work.goal, tell, stopped)
        with (
            undisturbed(),
            real_time(),
            LiveWires(work.cell, tell, work.tracks, self._guide.clock, work.feels) as wires,
        ):
            made = work.make(wires, wires.unless_told(tell))
            made.graph.rehearse()  # nothing is open yet
            led = led_by(wires.port, made, ReportClock(wires, round(made.graph.rate / RATE)))
            yield led
            is_whole = made.graph.ticks > 0 and not led.fault()
        if is_whole:
            self._guide.finished(work.room)

    def leave(self, tell: Tell, stopped: Callable[[], bool]) -> None:
        """Go up from where the last work has ended, if it came to its end."""
        self._guide.leave(tell, stopped)


def led_by(port: RobotPort, part: Part, clock: Clock) -> Part:
    """Return a part that a robot's reports beat: held where it is once its port has latched, and when all is over.

    Parameters
    ----------
    port : RobotPort
    part : Part
        With a retreat.
    clock : Clock
    """
    assert part.retreat is not None
    return replace(part, clock=clock, retreat=_Held(part.retreat, port).retreat, rest=port.stop)


class _Held:
    """The retreat of a graph, which is none where the robot's wire has latched: then it is held where it is."""

    def __init__(self, within: Retreat, port: RobotPort) -> None:
        self._within, self._port = within, port
        self.retreat = replace(within, fault=self.fault, begin=self._begin)

    def fault(self) -> str:
        return self._port.reason or self._within.fault()

    def _begin(self, reason: str) -> None:
        if not self._port.reason:
            self._within.begin(reason)
