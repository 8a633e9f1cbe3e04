"""A clamping experiment in its folder, over the wires or on the simulated arm: only what is not recorded yet."""

import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from calibration.joint_clamping.aside import Here, aside
from calibration.joint_clamping.maps_page import nothing
from calibration.joint_clamping.measurement import (
    APPROACH,
    ClampAborted,
    ClampRun,
    Tell,
    missing,
    recording_name,
)
from calibration.joint_clamping.requests import Requests
from ctlblocks import Block, recording
from ctlblocks.recording import Recording
from rigkit import atomic
from stagectl.link.bus import LinkError
from stagectl.link.clock import run_linked
from stagectl.link.priority import undisturbed
from stagectl.named_block import named_block
from stagectl.robot.arm import Arm
from stagectl.robot.clamp_config import clamp_procedure
from stagectl.robot.clamp_port import GuidedArm
from stagectl.robot.clamp_program import ClampProgram
from stagectl.robot.clamp_search import ClampSearch
from stagectl.robot.clamp_tracker import TrackedLinks
from stagectl.robot.config import CellConfig
from stagectl.robot.port import RobotPort, arm_of
from stagectl.robot.program import RobotProgram, TorqueSignals, begin_motion
from stagectl.wire.egm import RATE

NOTE = "config.json"
LATE_TICKS = 2
"""Ticks that may be late at once: one more is a fault of the port."""


def clamped_arm(cell: CellConfig) -> Arm:
    """Return the arm with its tool: the last link goes as far as the clamp."""
    return arm_of(cell).with_tool(cell.robot.tool)


def measure(
    cell: CellConfig, joints: Sequence[int], folder: Path, tell: Tell, asked: Requests
) -> tuple[dict[int, Recording], Recording | None]:
    """Run the procedure for the joints that have no recording yet; return those of all, and of the way to the clamp.

    Parameters
    ----------
    cell : CellConfig
    joints : sequence of int
        From 0.
    folder : Path
        Of raw recordings, `joint-1.wav` ...; made if it is not there.
    tell : callable(str)
        Told each step in words as it begins.
    asked : Requests

    Raises
    ------
    ValueError : a folder that belongs to another configuration, or limits that do not fit to the arm.
    LinkError : a wire that cannot be had, before anything moves.
    ClampAborted : something went wrong; what was recorded is kept.
    Stopped : it was asked to.
    """
    _refuse_another(folder, cell)
    left = missing(folder, joints)
    if left:
        search = ClampSearch(clamp_procedure(cell.clamping, clamped_arm(cell), left))
        (_run_live if cell.clamping.live else _run_simulated)(cell, search, folder, tell, asked)
    way = folder / APPROACH
    found = {joint: recording.read(folder / recording_name(joint)) for joint in joints}
    return found, recording.read(way) if way.exists() else None


def _refuse_another(folder: Path, cell: CellConfig) -> None:
    """Refuse a folder that was recorded with another configuration."""
    note = folder / NOTE
    if note.exists() and note.read_text(encoding="utf-8") != _told(cell):
        raise ValueError(f"{folder} was recorded with another configuration; choose another name for the model")


def _note(folder: Path, cell: CellConfig) -> None:
    """Make the folder, and note in it what it is recorded with: once everything is there that a recording wants."""
    folder.mkdir(parents=True, exist_ok=True)
    atomic.write(folder / NOTE, _told(cell))


def _told(cell: CellConfig) -> str:
    return cell.model_dump_json(indent=1)


def _run_simulated(cell: CellConfig, search: ClampSearch, folder: Path, tell: Tell, asked: Requests) -> None:
    run = ClampRun(simulated_robot(cell), search, RATE, folder, tell, asked, Here(), every_cycle=False)
    _note(folder, cell)
    while not run.look():
        run.graph.tick()
    run.finish()


def simulated_robot(cell: CellConfig) -> Block:
    """Build the simulated arm in its clamp that a cell's file names."""
    simulator = cell.simulator
    given = {"arm": cell.robot.arm, "tool": cell.robot.tool, "softness": cell.clamping.softness}
    given |= {"clamp": simulator.clamp, "clamp_turn": simulator.clamp_turn, "slip": simulator.slip}
    return named_block(simulator.clamped, {**given, **simulator.options})


def _run_live(cell: CellConfig, search: ClampSearch, folder: Path, tell: Tell, asked: Requests) -> None:
    """Run it with the robot's reports as the clock; whatever ends it, the robot is held where it is."""
    if not (cell.robot.commands and cell.robot.signals):
        raise ValueError(
            f"robot.commands is {cell.robot.commands} and robot.signals {cell.robot.signals}, must be ports of the "
            "robot: soft servo and clamp are asked for there, and torques come from there"
        )
    _refuse_haste(cell, search)
    given, cell = cell, cell.model_copy(update={"robot": cell.robot.model_copy(update={"mode": "joints"})})
    _compile(search)
    with ExitStack() as stack:
        work = stack.enter_context(aside(nothing))
        port = stack.enter_context(RobotPort(cell, lambda _, fields: tell(f"fault: {fields.get('reason', '')}")))
        peer = port.conversation.peer
        host = peer[0] if peer is not None else cell.robot.listen
        signals = stack.enter_context(TorqueSignals(cell.robot, host, time.monotonic))
        asks = stack.enter_context(RobotProgram(cell.robot, host))
        program = stack.enter_context(ClampProgram(asks, cell.clamping.softness, port.hold))
        patience = cell.robot.patience
        links = stack.enter_context(TrackedLinks(cell.tracker, patience=patience)) if cell.clamping.track else None
        if not signals.wait(1, patience):
            raise LinkError(f"no torque signals come from {host}:{cell.robot.signals} within {patience:g} s")
        robot = GuidedArm(port, program, signals, links)
        run = ClampRun(robot, search, RATE, folder, tell, asked, work, every_cycle=True)
        _note(folder, given)
        with undisturbed():
            begin_motion(port, asks)
            port.start()
            try:
                run_linked(run.graph, port, sys.maxsize, run.look)
            except LinkError as fault:
                raise ClampAborted(f"{port.reason or fault}; {run.where}") from fault
            finally:
                port.stop()
        if port.reason:
            raise ClampAborted(f"{port.reason}; {run.where}")
        run.finish()


def _refuse_haste(cell: CellConfig, search: ClampSearch) -> None:
    """Refuse speeds at which a tick or two that come late, and then at once, would be too fast for `limits.speed`."""
    arm, clamping = search.procedure.arm, cell.clamping
    most = cell.limits.speed * arm.speed / (LATE_TICKS + 1)
    for name, speed in (("approach", np.full(arm.joints, clamping.approach)), ("speed", np.array(clamping.speed))):
        wrong = np.flatnonzero(~(speed <= most))
        if len(wrong):
            joint = int(wrong[0])
            raise ValueError(
                f"clamping.{name} is {speed[joint]:g} rad/s for joint {joint + 1}, must be <= {most[joint]:.3g} rad/s: "
                f"limits.speed over {LATE_TICKS + 1}, since references that come late come together"
            )


def _compile(search: ClampSearch) -> None:
    """Have its kernel compiled before a robot waits for it."""
    search.prepare(RATE, 1)
    search.process(*(np.zeros((1, port.width)) for port in (*search.inputs, *search.outputs)))
