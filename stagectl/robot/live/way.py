"""The way to where a trial begins, and from where it has ended: up, across, and down, always over the workpiece."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ctlblocks import Graph
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from rigkit.priority import undisturbed
from rigkit.stop import Stopped
from stagectl.link.bus import LinkError
from stagectl.link.clock import run_linked
from stagectl.link.tell import Tell
from stagectl.robot.arm import Arm
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.live.wires import begin_motion_of, catch_up
from stagectl.robot.port import RobotPort
from stagectl.robot.port_blocks import JointCommand
from stagectl.robot.tool_path import joints_at
from stagectl.wire.robot import RATE

LATE = 3
"""References that may come at once, after ticks that were late: no joint may be faster than a part of its limit."""
REST = 0.5
"""s at the end of a way, until the robot has caught up."""
CLOSE = 1e-6
"""rad, from where it is to be."""
FINE = 200
"""Points of a leg by which its length is measured."""


@dataclass(frozen=True, eq=False)
class Room:
    """Where the tool may go over a workpiece.

    Parameters
    ----------
    arm : Arm
        To its tool point.
    top : float, m
        The workpiece's surface, z in the base.
    height : float, m
        Over it, where the tool goes across.
    speed : float, m/s, of the tool
    turn : array, shape (6,), rad/s, of the joints
    """

    arm: Arm
    top: float
    height: float
    speed: float
    turn: np.ndarray

    def up(self, here: np.ndarray) -> np.ndarray:
        """Return the joints with the tool straight above where it is, shape (6,), rad; where it is if that is high.

        Parameters
        ----------
        here : array, shape (6,), rad
        """
        place = forward(self.arm, here)[:3, 3]
        if place[2] >= self.top + self.height:
            return here
        return np.asarray(joints_at(self.arm, here, np.array([[place[0], place[1], self.top + self.height]]))[0])

    def rise(self, here: np.ndarray) -> np.ndarray:
        """Return the way straight up from where it is, shape (N, 6), rad, 250 samples/s."""
        return self.leg(here, self.up(here), True)

    def way(self, here: np.ndarray, there: np.ndarray) -> np.ndarray:
        """Return the way from where it is to where it is to be: shape (N, 6), rad, 250 samples/s.

        Parameters
        ----------
        here, there : arrays, shape (6,), rad

        Raises
        ------
        ValueError : out of reach, or across the tool would come too low.
        """
        if np.abs(there - here).max() < CLOSE:
            return here[None]
        above, over = self.up(here), self.up(there)
        across = self.leg(above, over, False)
        lowest = forward(self.arm, across)[:, 2, 3].min()
        if not lowest >= self.top + 0.5 * self.height:
            raise ValueError(
                f"on its way the tool would come down to z = {1e3 * lowest:.1f} mm, must stay above "
                f"{1e3 * (self.top + 0.5 * self.height):.1f} mm in the base: move the robot over the workpiece first"
            )
        down = self.leg(there, over, True)[::-1]
        return np.concatenate([self.leg(here, above, True), across, down, there[None]])

    def leg(self, here: np.ndarray, there: np.ndarray, is_straight: bool) -> np.ndarray:
        """Return a leg from rest to rest, shape (N, 6), rad, 250 samples/s.

        Parameters
        ----------
        here, there : arrays, shape (6,), rad
        is_straight : bool
            The tool goes straight, turned as it is; else joint by joint.
        """
        fine = self._points(here, there, np.linspace(0.0, 1.0, FINE), is_straight)
        length = np.linalg.norm(np.diff(forward(self.arm, fine)[:, :3, 3], axis=0), axis=1).sum()
        slowest = max(length / self.speed, float((np.abs(there - here) / self.turn).max()))
        count = int(np.ceil(0.5 * np.pi * slowest * RATE)) + 1
        part = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, count + 1) / count)
        return self._points(here, there, part, is_straight)

    def _points(self, here: np.ndarray, there: np.ndarray, part: np.ndarray, is_straight: bool) -> np.ndarray:
        if not is_straight:
            return np.asarray(here + part[:, None] * (there - here))
        first, last = (forward(self.arm, each)[:3, 3] for each in (here, there))
        return joints_at(self.arm, here, first + part[:, None] * (last - first))


def room_of(cell: CellConfig, arm: Arm, top: float) -> Room:
    """Return the room over a workpiece, with the joints as fast as the cell's limits and late ticks let them be.

    Parameters
    ----------
    cell : CellConfig
    arm : Arm
        To its tool point.
    top : float, m
        The workpiece's surface, z in the base.
    """
    robot, limits = cell.robot, cell.limits
    speed = min(robot.travel, limits.tool_speed / LATE)
    return Room(arm, top, robot.height, speed, limits.speed * arm.speed / LATE)


def go(
    cell: CellConfig,
    plan: Callable[[np.ndarray], np.ndarray],
    tell: Tell,
    stopped: Callable[[], bool],
    now: Callable[[], float] = time.monotonic,
) -> None:
    """Lead the robot along a way from where it is, and hold it at its end.

    Parameters
    ----------
    cell : CellConfig
    plan : callable(array) -> array
        From where it is, shape (6,), rad, to its way, shape (N, 6), rad.
    tell : callable(event, fields)
        Told of faults.
    stopped : callable() -> bool
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    ValueError : the way is refused.
    LinkError : the robot is not there, or a fault; it is held.
    Stopped : it was asked to; the robot is held.
    """
    cell = cell.model_copy(update={"robot": cell.robot.model_copy(update={"mode": "joints"})})
    with undisturbed(), RobotPort(cell, tell, now) as port:
        begin_motion_of(port)
        way = plan(port.conversation.where.copy())
        rests = np.concatenate([way, np.tile(way[-1], (round(REST * RATE), 1))])
        graph = _graph(port, rests)
        catch_up(port)
        port.start()
        try:
            done = run_linked(graph, port, len(rests), stopped)
        except LinkError as fault:
            raise LinkError(f"{port.reason or fault}; the robot is held on its way over the workpiece") from fault
    if done < len(rests):
        raise Stopped(f"stopped on the robot's way, {done / RATE:.1f} of {len(rests) / RATE:.1f} s: it is held there")


def _graph(port: RobotPort, way: np.ndarray) -> Graph:
    names = tuple(f"{name}_{joint}" for name in ("nominal", "correction") for joint in range(1, 7))
    played = Recording(names, ("rad",) * 12, RATE, np.hstack([way, np.zeros_like(way)]))
    graph = Graph(RATE)
    graph.add("way", Replay(played, {"nominal": names[:6], "correction": names[6:]}))
    graph.add("send", JointCommand(port))
    for name in ("nominal", "correction"):
        graph.connect(f"way.{name}", f"send.{name}")
    graph.prepare()
    return graph
