"""A clamping experiment in its folder, over the wires or on the simulated arm: only what is not recorded yet."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from calibration.guided_arm import arm_with_tool, lead, refuse_haste, wired_arm
from calibration.joint_clamping.aside import Here, aside
from calibration.joint_clamping.maps_page import nothing
from calibration.joint_clamping.measurement import (
    APPROACH,
    ClampAborted,
    ClampRun,
    Tell,
    missing,
    recording_name,
    require_room,
    unwatched,
)
from calibration.joint_clamping.requests import Requests
from ctlblocks import Block, recording
from ctlblocks.recording import Recording
from rigkit.agreement import GOING_ON
from rigkit.named_code import named_block
from stagectl.link.bus import LinkError
from stagectl.robot.clamp_config import clamp_procedure
from stagectl.robot.clamp_search import ClampSearch
from stagectl.robot.config import CellConfig
from stagectl.wire.egm import RATE

KIND = "calibration of joints"
KEPT = GOING_ON.without(
    "midranging", "toroid", "feedback", "plants", "force", "pocket", "learning", "friction", "force_estimate",
    "segments", "feed_plants", "chirp", "force_sensor", "link",
)  # fmt: skip
"""What an unfinished one must have kept."""
Watch = Callable[[ClampRun], object]


def measure(
    cell: CellConfig,
    joints: Sequence[int],
    folder: Path,
    tell: Tell,
    asked: Requests,
    watch: Watch = unwatched,
    only_recorded: bool = False,
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
    watch : callable(ClampRun)
        Called after every tick.
    only_recorded : bool
        Whether nothing may move.

    Raises
    ------
    ValueError : limits that do not fit to the arm, or a recording is missing and nothing may move.
    DiskFault : the disk has no room for the joints that are missing.
    LinkError : a wire that cannot be had, before anything moves.
    ClampAborted : something went wrong; what was recorded is kept.
    Stopped : it was asked to.
    """
    left = missing(folder, joints)
    if left and only_recorded:
        raise ValueError(f"{folder}/ has no recording of joint {left[0] + 1}, and nothing is to be measured")
    if left:
        require_room(folder, len(left))
        search = ClampSearch(clamp_procedure(cell.clamping, arm_with_tool(cell), left))
        (_run_live if cell.clamping.live else _run_simulated)(cell, search, folder, tell, asked, watch)
    way = folder / APPROACH
    found = {joint: recording.read(folder / recording_name(joint)) for joint in joints}
    return found, recording.read(way) if way.exists() else None


def _run_simulated(
    cell: CellConfig, search: ClampSearch, folder: Path, tell: Tell, asked: Requests, watch: Watch
) -> None:
    run = ClampRun(simulated_robot(cell), search, RATE, folder, tell, asked, Here(), False, watch)
    folder.mkdir(parents=True, exist_ok=True)
    while not run.look():
        run.graph.tick()
    run.finish()


def simulated_robot(cell: CellConfig) -> Block:
    """Build the simulated arm in its clamp that a cell's file names."""
    simulator = cell.simulator
    given = {"arm": cell.robot.arm, "tool": cell.robot.tool, "softness": cell.clamping.softness}
    given |= {"clamp": simulator.clamp, "clamp_turn": simulator.clamp_turn, "slip": simulator.slip}
    return named_block(simulator.clamped, {**given, **simulator.options})


def _run_live(cell: CellConfig, search: ClampSearch, folder: Path, tell: Tell, asked: Requests, watch: Watch) -> None:
    """Run it with the robot's reports as the clock; whatever ends it, the robot is held where it is."""
    arm, clamping = search.procedure.arm, cell.clamping
    approach = [clamping.approach] * arm.joints
    refuse_haste(cell, arm, {"clamping.approach": approach, "clamping.speed": clamping.speed})
    _compile(search)
    with aside(nothing) as work, wired_arm(cell, clamping.track, tell) as robot:
        run = ClampRun(robot, search, RATE, folder, tell, asked, work, True, watch)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            lead(robot, run.graph, run.look)
        except LinkError as fault:
            raise ClampAborted(f"{fault}; {run.where}") from fault
        run.finish()


def _compile(search: ClampSearch) -> None:
    """Have its kernel compiled before a robot waits for it."""
    search.prepare(RATE, 1)
    search.process(*(np.zeros((1, port.width)) for port in (*search.inputs, *search.outputs)))
