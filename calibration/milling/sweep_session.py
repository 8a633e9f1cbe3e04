"""A sweep run on the simulated arm or over the wires, recorded as it goes."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from calibration.guided_arm import LATE_TICKS, arm_with_tool, led_arm, refuse_haste
from calibration.joint_clamping.session import simulated_robot
from calibration.milling.sweep_block import Sweep
from calibration.milling.sweep_plan import SweepBox, SweepStep, path_of, plan_sweep
from ctlblocks import Block, Graph, Port
from ctlblocks.recording import Recording
from ctlblocks.taps import Tap
from rigkit.experiment.kept import records_of
from rigkit.experiment.once import Once
from rigkit.experiment.part import Part, Phase, Retreat, Track
from rigkit.experiment.runner import Conduct
from rigkit.run_folder import RunFolder
from stagectl.robot.arm import Arm
from stagectl.robot.config import CellConfig
from stagectl.wire.robot import RATE

NAME = "sweep"
"""Of the part, and of its recording."""
SEEN, MADE = ("angle", "torque", "fault"), ("reference", "step")
"""What is recorded of the robot, and of the block that moves it."""
APPROACH = 0.05
"""rad/s, of the fastest joint on the way to the sweep's first pose."""
LONGEST_WAY = 600.0
"""s there, at most."""
HELD = 0.5
"""s that are recorded of an arm that is held before the sweep's end."""

Tell = Callable[[str], None]


def sweep_steps(cell: CellConfig) -> list[SweepStep]:
    """Return the sweep's motions, from and to `clamping.leave`, for a dry run as well.

    Raises
    ------
    ValueError : ranges that do not fit to the arm, or poses in which the tool leaves its box.
    """
    return plan_sweep(cell.friction, arm_with_tool(cell), _box(cell), _start(cell))


def sweep_path(cell: CellConfig) -> np.ndarray:
    """Return the sweep's references, shape (samples, 6), rad, 250 a second."""
    return path_of(sweep_steps(cell), _start(cell), RATE)[0]


def sweep(cell: CellConfig, live: bool, folder: RunFolder, tell: Tell, conduct: Conduct) -> Recording:
    """Run the sweep, recorded as it goes, and return what is recorded of its motions; one that is there is read.

    Parameters
    ----------
    cell : CellConfig
    live : bool
        The robot behind the wires of [robot]; else the simulated one.
    folder : RunFolder
        Of the raw recordings.
    tell : callable(str)
        Told each motion in words as it begins.
    conduct : Conduct

    Raises
    ------
    ValueError : limits that do not fit to the arm; before anything moves.
    LinkError : a wire that cannot be had.
    PartEnded, Stopped : a fault, or a person, ended it: the arm holds; what was recorded until then is kept.
    """
    once = Once(folder, conduct)
    if not once.has(NAME):
        steps = sweep_steps(cell)
        path, numbers = path_of(steps, _start(cell), RATE)
        once.run(NAME, _made(cell, live, path, SweepRun(Sweep(path, numbers, APPROACH), steps, len(path), tell)))
    record = records_of(folder.path, NAME)[NAME]
    return replace(record, data=record.data[record.select(["step_1"]).data[:, 0] > 0])


def is_swept(folder: RunFolder) -> bool:
    """Whether there is a sweep in a folder that has come to its end."""
    return Once(folder, Conduct()).has(NAME)


@contextmanager
def _made(cell: CellConfig, live: bool, path: np.ndarray, run: "SweepRun") -> Iterator[Part]:
    if not live:
        yield run.part(simulated_robot(cell))
        return
    _refuse_haste(cell, arm_with_tool(cell), path)
    with led_arm(cell, False, run.tell, run.part) as part:
        yield part


def _box(cell: CellConfig) -> SweepBox:
    """Return where the tool may be, and at which speed three references that come at once are within its limit."""
    limits = cell.limits
    return SweepBox(limits.lowest, limits.highest, limits.tool_speed / (LATE_TICKS + 1))


def _start(cell: CellConfig) -> np.ndarray:
    return np.radians(cell.clamping.leave)


def _refuse_haste(cell: CellConfig, arm: Arm, path: np.ndarray) -> None:
    fastest = np.abs(np.diff(path, axis=0)).max(axis=0) * RATE
    refuse_haste(cell, arm, {"the sweep": list(fastest), "its approach": [APPROACH] * arm.joints})


class SweepRun:
    """A sweep as a part of an experiment, told of as it goes.

    Parameters
    ----------
    block : Sweep
    steps : list of SweepStep
    samples : int
        Of its path.
    tell : callable(str)
    """

    def __init__(self, block: Sweep, steps: list[SweepStep], samples: int, tell: Tell) -> None:
        self.tell = tell
        self._block, self._steps, self._samples, self._said = block, steps, samples, 0
        self._graph = Graph(RATE)

    def part(self, robot: Block) -> Part:
        """Return it on a robot: a block with the ports of `Sweep`, the other way round, and torques."""
        graph = self._graph
        graph.add("robot", robot)
        graph.add("sweep", self._block)
        for name in ("angle", "fault"):
            graph.connect(f"robot.{name}", f"sweep.{name}")
        for name in ("reference", "soft", "clamp"):
            graph.connect(f"sweep.{name}", f"robot.{name}", delayed=True)
        taps = [*(Tap(name, f"robot.{name}") for name in SEEN), *(Tap(name, f"sweep.{name}") for name in MADE)]
        phases = (
            Phase("way", round(LONGEST_WAY * RATE), every=1, look=lambda: self._block.is_there),
            Phase("motions", self._samples, every=1, look=self._look),
        )
        track = Track(NAME, tuple(taps), frozenset(MADE), channels=_numbered)
        return Part(NAME, graph, (track,), phases, retreat=Retreat(self._fault, self._hold, round(HELD * RATE)))

    def _look(self) -> bool:
        """Tell of each motion as it begins; return whether the path has ended."""
        step = int(self._graph.signal("sweep.step")[0, 0])
        if step > self._said:
            self._said = step
            self.tell(f"{self._graph.ticks / RATE:7.1f} s  {self._steps[step - 1].words}")
        return self._block.done

    def _fault(self) -> str:
        return f"the robot is at fault; {self._where}" if self._block.is_faulty else ""

    def _hold(self, _: str) -> None:
        self._block.hold()
        self.tell(f"{self._graph.ticks / RATE:7.1f} s  {self._where}")

    @property
    def _where(self) -> str:
        return f"in motion {max(self._said, 1)} of {len(self._steps)}: the arm holds"


def _numbered(port: Port) -> tuple[str, ...]:
    return tuple(f"{port.name}_{number}" for number in range(1, port.width + 1))
