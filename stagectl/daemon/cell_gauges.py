"""What is measured of the cell now, against its limits."""

from collections.abc import Iterator

import numpy as np

from rigkit.experiment.watch import LOOKS, Watch
from rigkit.service.show import Gauge
from stagectl.daemon.gauges import paced
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.port import arm_of

REFERENCE = {"reference": "port.reference"}
"""Where `Motion` sees the references that have passed the port's guard."""


class Motion:
    """Gauges of the tool in its box and of the joints' speeds, as they are asked of the robot: what the guard limits.

    Parameters
    ----------
    cell : CellConfig
        As it is run, with the box of its path.
    idle : float or None, m/s
        Speed while nothing is ticked: a simulated robot is not there then.  None where that is not known.
    """

    def __init__(self, cell: CellConfig, idle: float | None = 0.0) -> None:
        self._limits, self._idle = cell.limits, idle
        bare = arm_of(cell)
        self._arm, self._speed = bare.with_tool(cell.robot.tool), cell.limits.speed * bare.speed

    def gauges(self, watch: Watch) -> Iterator[Gauge]:
        """Give them; while nothing is ticked, the speed alone."""
        limits = self._limits
        now, before = watch.newest("reference"), watch.newest("reference", back=1)
        if now is None:
            yield self._speed_of_tool(self._idle)
            return
        last = now if before is None else before
        place, placed = forward(self._arm, np.stack([now, last]))[:, :3, 3]
        yield self._speed_of_tool(float(np.linalg.norm(place - placed)) * LOOKS)
        for axis, at, low, high in zip("xyz", place.tolist(), limits.lowest, limits.highest, strict=True):
            yield Gauge(f"tool_{axis}", f"Tool {axis}, in its box", at, "m", low, high)
        turning = (np.abs(now - last) * LOOKS).tolist()
        for joint, (value, most) in enumerate(zip(turning, self._speed.tolist(), strict=True), start=1):
            yield Gauge(f"joint_speed_{joint}", f"Joint {joint}, speed", value, "rad/s", high=most)

    def _speed_of_tool(self, speed: float | None) -> Gauge:
        return Gauge("tool_speed", "Tool speed", speed, "m/s", high=self._limits.tool_speed, is_output=True)


def sighted(watch: Watch, cell: CellConfig) -> Iterator[Gauge]:
    """Give how long ago the tracker saw what it follows; `age`, s, is among the signals."""
    age = watch.newest("age")
    if age is not None:
        yield Gauge("tracker_age", "Tracker, last sight", float(age[0]), "s", high=cell.tracker.blind)


def felt(watch: Watch, most: float) -> Iterator[Gauge]:
    """Give the size of the force on the tool, N, against `most`; `force` and `valid` are among the signals."""
    force, valid = watch.newest("force"), watch.newest("valid")
    if force is not None and valid is not None:
        size = float(np.linalg.norm(force)) if valid[0] else None
        yield Gauge("force", "Force on the tool", size, "N", high=most)


def milling(watch: Watch, motion: Motion, cell: CellConfig) -> Iterator[Gauge]:
    """Give, of a trial, where the tool is, how fast the joints turn, when it was seen, and the force on it."""
    yield from motion.gauges(watch)
    yield from sighted(watch, cell)
    yield from felt(watch, max(cell.force_sensor.range_force))
    yield from timed(watch)


def timed(watch: Watch) -> Iterator[Gauge]:
    """Give how a simulation in real time keeps to the clock."""
    if watch.pace is not None:
        yield from paced(watch.pace)
