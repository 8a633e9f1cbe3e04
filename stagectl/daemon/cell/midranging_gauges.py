"""What is measured of a pair while it shares a position: simulated, or the robot and the stage themselves."""

from collections.abc import Iterator, Sequence

import numpy as np

from rigkit.service.show import Gauge
from stagectl.daemon.cell.gauges import timed
from stagectl.daemon.cell.watch import LOOKS, Watch
from stagectl.daemon.gauges import linked
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.config import MidrangeConfig
from stagectl.robot.midranging.live_pair import LivePair

SIMULATED = {name: f"pair.{name}" for name in ("position", "fast", "slow", "control")}
LIVE = {name: f"seen.{name}" for name in SIMULATED} | {"asked": "controller.slow_reference"}
"""What is seen of either, beside the reference."""


def of_a_simulation(watch: Watch, config: MidrangeConfig) -> Iterator[Gauge]:
    """Give the control signal, which is the output, and the micro manipulator's position; 0 while nothing is ticked."""
    control = watch.newest("control")
    most = config.inner.limit
    signal = 0.0 if control is None else float(control[0])
    yield Gauge("control", "Control signal of the micro manipulator", signal, "m/s", -most, most, is_output=True)
    yield from _micro(watch, config, ("",))
    yield from timed(watch)


def of_a_live_pair(watch: Watch, cell: CellConfig, axes: Sequence[str], pair: LivePair) -> Iterator[Gauge]:
    """Give the speed that the robot is asked for and whether the stage is led, which are the output, and the rest.

    Parameters
    ----------
    watch : Watch
    cell : CellConfig
    axes : sequence of str
        Those that are shared: x, y or z.
    pair : LivePair
        With its wires open.
    """
    now, before = watch.newest("asked"), watch.newest("asked", back=1)
    speed = 0.0 if now is None or before is None else float(np.linalg.norm(now - before)) * LOOKS
    most = cell.limits.tool_speed
    yield Gauge("tool_speed", "Tool speed that is asked of the robot", speed, "m/s", high=most, is_output=True)
    control, limit = watch.newest("control"), cell.midranging.inner.limit
    for axis, signal in zip(axes, () if control is None else control.tolist(), strict=False):
        yield Gauge(f"control_{axis}", f"Control signal of the stage, {axis}", signal, "m/s", -limit, limit)
    yield from _micro(watch, cell.midranging, axes)
    yield from linked(pair.stage)


def _micro(watch: Watch, config: MidrangeConfig, axes: Sequence[str]) -> Iterator[Gauge]:
    fast, most = watch.newest("fast"), config.pair.travel
    for axis, at in zip(axes, () if fast is None else fast.tolist(), strict=False):
        name, title = (f"micro_{axis}", f"Micro manipulator, {axis}") if axis else ("micro", "Micro manipulator")
        yield Gauge(name, f"{title}, from its middle", at - config.pair.middle, "m", -most, most)
