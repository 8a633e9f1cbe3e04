"""A clamping experiment in its folder, over the wires or on the simulated arm: only what is not recorded yet."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field

import numpy as np

from calibration.guided_arm import arm_with_tool, led_arm, refuse_haste
from calibration.joint_clamping import recorded_joints
from calibration.joint_clamping.aside import Here, aside
from calibration.joint_clamping.maps_page import nothing
from calibration.joint_clamping.measurement import ClampRun, GrowingMaps, Tell
from calibration.joint_clamping.recorded_joints import missing, next_procedure, require_room, take_out
from ctlblocks import Block
from ctlblocks.recording import Recording
from rigkit.agreement import GOING_ON
from rigkit.experiment.once import Once, PartEnded
from rigkit.experiment.part import Part
from rigkit.experiment.runner import Conduct, never
from rigkit.named_code import named_block
from rigkit.run_folder import RunFolder
from rigkit.stop import Stopped
from stagectl.robot.clamp_config import clamp_procedure
from stagectl.robot.clamp_search import ClampSearch
from stagectl.robot.config import CellConfig
from stagectl.wire.robot import RATE

KIND = "calibration of joints"
KEPT = GOING_ON.without(
    "midranging", "toroid", "feedback", "plants", "force", "pocket", "learning", "friction", "force_estimate",
    "segments", "feed_plants", "chirp", "force_sensor", "link",
)  # fmt: skip
"""What an unfinished one must have kept."""


def unseen(run: ClampRun) -> None:
    """Look at nothing."""


@dataclass(frozen=True)
class Desk:
    """Who conducts a procedure, and who hears of it.

    Parameters
    ----------
    tell : callable(str)
        Told each step in words as it begins.
    conduct : Conduct
    pauses : callable() -> bool
        Whether the arm is to stay where it is; asked in every tick.
    begun : callable(ClampRun)
        Called with each procedure before its first tick.
    """

    tell: Tell
    conduct: Conduct = field(default_factory=Conduct)
    pauses: Callable[[], bool] = never
    begun: Callable[[ClampRun], object] = unseen


def measure(
    cell: CellConfig, joints: Sequence[int], folder: RunFolder, desk: Desk, only_recorded: bool = False
) -> tuple[dict[int, Recording], Recording | None]:
    """Run the procedure for the joints that have no recording yet; return those of all, and of the way to the clamp.

    Parameters
    ----------
    cell : CellConfig
    joints : sequence of int
        From 0.
    folder : RunFolder
        Of raw recordings: the procedures', as they go, and those of each joint taken out of them.
    desk : Desk
    only_recorded : bool
        Whether nothing may move.

    Raises
    ------
    ValueError : limits that do not fit to the arm, or a recording is missing and nothing may move.
    DiskFault : the disk has no room for the joints that are missing.
    LinkError : a wire that cannot be had, before anything moves.
    PartEnded : something went wrong; what was recorded is kept.
    Stopped : it was asked to.
    """
    path = folder.path
    take_out(path)  # of one that was killed
    left = missing(path, joints)
    if left and only_recorded:
        raise ValueError(f"{path}/ has no recording of joint {left[0] + 1}, and nothing is to be measured")
    if left:
        require_room(path, len(left))
        search = ClampSearch(clamp_procedure(cell.clamping, arm_with_tool(cell), left))
        try:
            _run(cell, search, folder, desk)
        finally:
            take_out(path)
    return recorded_joints.read(path, joints)


def _run(cell: CellConfig, search: ClampSearch, folder: RunFolder, desk: Desk) -> None:
    is_live = cell.clamping.live
    with beside(cell, nothing) as work:
        maps = GrowingMaps(folder.path, work, is_live)
        run = ClampRun(next_procedure(folder.path), search, desk.tell, desk.pauses, maps)
        try:
            Once(folder, desk.conduct).run(run.name, (_live if is_live else _simulated)(cell, run, desk))
        except PartEnded as fault:
            raise PartEnded(f"{fault}; the arm holds in {run.where}, soft servo and clamp stay") from None
        except Stopped:
            raise Stopped(f"stopped in {run.where}: the arm holds; finished joints are stored") from None
        finally:
            maps.finish()


def beside(cell: CellConfig, prepare: Callable[[], None]) -> AbstractContextManager[Executor]:
    """Give what draws and fits: a process of its own where a robot waits for this one, which calls `prepare` first."""
    return aside(prepare) if cell.clamping.live else nullcontext(Here())


@contextmanager
def _simulated(cell: CellConfig, run: ClampRun, desk: Desk) -> Iterator[Part]:
    made = run.part(simulated_robot(cell))
    desk.begun(run)
    yield made


def simulated_robot(cell: CellConfig) -> Block:
    """Build the simulated arm in its clamp that a cell's file names."""
    simulator = cell.simulator
    given = {"arm": cell.robot.arm, "tool": cell.robot.tool, "softness": cell.clamping.softness}
    given |= {"clamp": simulator.clamp, "clamp_turn": simulator.clamp_turn, "slip": simulator.slip}
    return named_block(simulator.clamped, {**given, **simulator.options})


@contextmanager
def _live(cell: CellConfig, run: ClampRun, desk: Desk) -> Iterator[Part]:
    """With the robot's reports as the clock; whatever ends it, the robot is held where it is."""
    arm, clamping = run.search.procedure.arm, cell.clamping
    if cell.robot.is_whole:
        raise ValueError(
            f"robot.wire is {cell.robot.wire}, whose messages carry no soft servo, must be one with a program of its "
            "own, such as egm, to clamp joints"
        )
    approach = [clamping.approach] * arm.joints
    refuse_haste(cell, arm, {"clamping.approach": approach, "clamping.speed": clamping.speed})
    _compile(run.search)
    with led_arm(cell, clamping.track, desk.tell, run.part) as part:
        desk.begun(run)
        yield part


def _compile(search: ClampSearch) -> None:
    """Have its kernel compiled before a robot waits for it."""
    search.prepare(RATE, 1)
    search.process(*(np.zeros((1, port.width)) for port in (*search.inputs, *search.outputs)))
