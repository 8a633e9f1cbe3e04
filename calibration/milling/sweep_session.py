"""A sweep run on the simulated arm or over the wires, and its record kept raw."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from calibration.guided_arm import LATE_TICKS, arm_with_tool, lead, refuse_haste, wired_arm
from calibration.joint_clamping.samples import Samples
from calibration.joint_clamping.session import simulated_robot
from calibration.milling.sweep_block import Sweep
from calibration.milling.sweep_plan import SweepBox, SweepStep, path_of, plan_sweep
from ctlblocks import Block, Graph, recording
from ctlblocks.recording import Recording
from rigkit.stop import Stopped, StopRequest
from stagectl.link.bus import LinkError
from stagectl.robot.arm import Arm
from stagectl.robot.config import CellConfig
from stagectl.wire.egm import RATE

SEEN = {"angle": "rad", "torque": "N m", "step": "1"}
"""What is kept, and its units."""
APPROACH = 0.05
"""rad/s, of the fastest joint on the way to the sweep's first pose."""

Tell = Callable[[str], None]
Watch = Callable[[Graph], object]


def unwatched(graph: Graph) -> None:  # noqa: ARG001 (an observer's own argument)
    """Look at nothing."""


class SweepAborted(ValueError):
    """The sweep was aborted; the text says why, and where the arm stands."""


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


def sweep(
    cell: CellConfig, live: bool, file: Path, tell: Tell, stop: StopRequest, watch: Watch = unwatched
) -> Recording:
    """Run the sweep, write its record, and return it; a record that is there already is read.

    Parameters
    ----------
    cell : CellConfig
    live : bool
        The robot behind the wires of [robot]; else the simulated one.
    file : Path
        Of the record, `.wav`.
    tell : callable(str)
        Told each motion in words as it begins.
    stop : StopRequest
    watch : callable(Graph)
        Called after every tick.

    Raises
    ------
    ValueError : limits that do not fit to the arm; before anything moves.
    LinkError : a wire that cannot be had.
    SweepAborted : a fault; what was recorded until then is kept as `file` with `.aborted.wav`.
    Stopped : it was asked to.
    """
    if file.exists():
        return recording.read(file)
    steps = sweep_steps(cell)
    path, numbers = path_of(steps, _start(cell), RATE)
    block = Sweep(path, numbers, APPROACH)
    if not live:
        run, cause = _SweepRun(simulated_robot(cell), block, steps, tell, stop, watch), ""
        while not run.look():
            run.graph.tick()
        return run.finish(file, cause)
    _refuse_haste(cell, arm_with_tool(cell), path)
    with wired_arm(cell, False, tell) as robot:
        run, cause = _SweepRun(robot, block, steps, tell, stop, watch), ""
        try:
            lead(robot, run.graph, run.look)
        except LinkError as fault:
            cause = str(fault)
        return run.finish(file, cause)


def _box(cell: CellConfig) -> SweepBox:
    """Return where the tool may be, and at which speed three references that come at once are within its limit."""
    limits = cell.limits
    return SweepBox(limits.lowest, limits.highest, limits.tool_speed / (LATE_TICKS + 1))


def _start(cell: CellConfig) -> np.ndarray:
    return np.radians(cell.clamping.leave)


def _refuse_haste(cell: CellConfig, arm: Arm, path: np.ndarray) -> None:
    fastest = np.abs(np.diff(path, axis=0)).max(axis=0) * RATE
    refuse_haste(cell, arm, {"the sweep": list(fastest), "its approach": [APPROACH] * arm.joints})


class _SweepRun:
    """A sweep in a graph that somebody ticks, and what is kept of it."""

    def __init__(
        self, robot: Block, block: Sweep, steps: list[SweepStep], tell: Tell, stop: StopRequest, watch: Watch
    ) -> None:
        self.graph, self.block = Graph(RATE), block
        self.graph.add("robot", robot)
        self.graph.add("sweep", block)
        for name in ("angle", "fault"):
            self.graph.connect(f"robot.{name}", f"sweep.{name}")
        for name in ("reference", "soft", "clamp"):
            self.graph.connect(f"sweep.{name}", f"robot.{name}", delayed=True)
        self.graph.prepare()
        self._steps, self._tell, self._stop, self._watch, self._said = steps, tell, stop, watch, 0
        self._step = self.graph.signal("sweep.step")
        signals = {"angle": "robot.angle", "torque": "robot.torque", "step": "sweep.step"}
        self._samples = Samples({name: self.graph.signal(signal) for name, signal in signals.items()}, SEEN)

    def look(self) -> bool:
        """Keep what the last tick showed; return whether the run is over."""
        step = int(self._step[0, 0])
        if self.graph.ticks:
            self._watch(self.graph)
        if step > 0:
            self._samples.keep()
        if step > self._said:
            self._said = step
            self._tell(f"{self.graph.ticks / RATE:7.1f} s  {self._steps[step - 1].words}")
        return self.block.done or self.block.is_faulty or self._stop.made

    def finish(self, file: Path, cause: str) -> Recording:
        """Write what was kept, and say how it ended; a `cause` is why it was aborted from outside."""
        cause = cause or ("the robot is at fault" if self.block.is_faulty else "")
        if len(self._samples) and (cause or not self.block.done):
            recording.write(file.with_suffix(".aborted.wav"), self._samples.recording(RATE))
        where = f"in motion {max(self._said, 1)} of {len(self._steps)}: the arm holds"
        if cause:
            raise SweepAborted(f"{cause}; {where}")
        if not self.block.done:
            raise Stopped(f"stopped {where}")
        recording.write(file, self._samples.recording(RATE))
        return recording.read(file)
