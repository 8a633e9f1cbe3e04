"""An arm over its wires for an experiment: guided motion, the program beside it, torque signals, tracked links."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from ctlblocks import Block, Graph
from rigkit.experiment.part import Part
from rigkit.priority import undisturbed
from stagectl.link.bus import LinkError
from stagectl.link.clock import Linked
from stagectl.robot.arm import Arm
from stagectl.robot.beside import await_torques, program_of, torques_of
from stagectl.robot.clamp_port import GuidedArm
from stagectl.robot.clamp_program import ClampProgram
from stagectl.robot.clamp_tracker import TrackedLinks
from stagectl.robot.config import CellConfig
from stagectl.robot.live.led import led_by
from stagectl.robot.port import RobotPort, arm_of
from stagectl.robot.program import begin_motion

LATE_TICKS = 2
"""Ticks that may be late at once: one more is a fault of the port."""


def arm_with_tool(cell: CellConfig) -> Arm:
    """Return the arm with its tool: the last link goes as far as the tool's point."""
    return arm_of(cell).with_tool(cell.robot.tool)


@contextmanager
def wired_arm(cell: CellConfig, track: bool, tell: Callable[[str], None]) -> Iterator[GuidedArm]:
    """Open all wires of the robot that stands ready, and close them again; the robot is held when they are.

    Parameters
    ----------
    cell : CellConfig
    track : bool
        Whether the tracker is listened to as well.
    tell : callable(str)
        Told of faults.

    Raises
    ------
    ValueError : the cell's file names no ports for program and torque signals.
    LinkError : a wire that cannot be had.
    """
    robot = cell.robot
    if not (robot.has_program and robot.has_torques):
        raise ValueError(
            f"robot.commands is {robot.commands} and robot.signals {robot.signals}, must be ports of the robot: soft "
            "servo and clamp are asked for there, and torques come from there"
        )
    cell = cell.model_copy(update={"robot": robot.model_copy(update={"mode": "joints"})})
    with ExitStack() as stack:
        port = stack.enter_context(RobotPort(cell, lambda _, fields: tell(f"fault: {fields.get('reason', '')}")))
        signals = torques_of(port, time.monotonic)
        stack.enter_context(signals)
        asks = stack.enter_context(program_of(port))
        program = stack.enter_context(ClampProgram(asks, cell.clamping.softness, port.hold))
        links = stack.enter_context(TrackedLinks(cell.tracker, patience=robot.patience)) if track else None
        await_torques(signals, port)
        begin_motion(port, asks)
        yield GuidedArm(port, program, signals, links)


@contextmanager
def led_arm(
    cell: CellConfig, track: bool, tell: Callable[[str], None], make: Callable[[Block], Part]
) -> Iterator[Part]:
    """Give a part on the arm behind its wires, as `wired_arm` opens them: its reports beat it, and hold its faults.

    Parameters
    ----------
    cell, track, tell
        As of `wired_arm`.
    make : callable(Block) -> Part
        Makes it on the arm, with a retreat.

    Raises
    ------
    ValueError, LinkError : as of `wired_arm`.
    """
    with undisturbed(), wired_arm(cell, track, tell) as robot:
        yield led_by(robot.port, make(robot), ArmClock(robot.port))


class ArmClock:
    """Ticks a graph once for each report of a robot, which follows from the first tick on, until its port latches.

    Parameters
    ----------
    port : RobotPort, open
    """

    def __init__(self, port: RobotPort) -> None:
        self._port, self._beats = port, Linked(port)
        self._has_begun = False

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:
        """Tick so many times, or until `over` or a fault of the port; return the ticks run.

        Raises
        ------
        LinkError : the robot cannot be led, before the first tick; or it is not heard and nothing has latched.
        """
        port, before = self._port, graph.ticks
        if not self._has_begun:
            port.wait(port.skip() + 1, port.patience)  # it may have been missed while garbage was collected
            port.start()
            self._has_begun = True
        try:
            return self._beats.run(graph, ticks, over)
        except LinkError as fault:
            port.hold(str(fault))
            if not port.reason:
                raise
            return graph.ticks - before


def refuse_haste(cell: CellConfig, arm: Arm, speeds: Mapping[str, Sequence[float]]) -> None:
    """Refuse speeds at which a tick or two that come late, and then at once, would be too fast for `limits.speed`.

    Parameters
    ----------
    cell : CellConfig
    arm : Arm
    speeds : mapping of str to numbers, rad/s
        By their key in the cell's file; a number a joint.
    """
    most = cell.limits.speed * arm.speed / (LATE_TICKS + 1)
    for name, speed in speeds.items():
        wrong = np.flatnonzero(~(np.asarray(speed) <= most))
        if len(wrong):
            joint = int(wrong[0])
            raise ValueError(
                f"{name} is {speed[joint]:g} rad/s for joint {joint + 1}, must be <= {most[joint]:.3g} rad/s: "
                f"limits.speed over {LATE_TICKS + 1}, since references that come late come together"
            )
