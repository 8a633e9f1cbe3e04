"""What is seen, under the daemon, of the pair of manipulators while something is asked of it."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np

from rigkit.experiment.procedure import Strip, strips_of
from rigkit.experiment.watch import LOOKS, Watch
from rigkit.service.show import Gauge, Panel
from stagectl.daemon.cell_gauges import timed
from stagectl.daemon.gauges import linked
from stagectl.experiments.midranging.wired_blocks import LivePair
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging_config import MidrangeConfig

MEASURED = ("position", "fast", "slow", "control")


class OnPair(Protocol):
    """An experiment on the pair: its settings, its axes, and both manipulators while their wires are open."""

    cell: CellConfig
    config: MidrangeConfig
    is_live: bool
    axes: list[str]
    pair: LivePair | None


class PairView:
    """What is seen of a run: of the pair simulated, or of the robot and the stage themselves.

    Parameters
    ----------
    made : OnPair
    asked : mapping of str to str
        Outputs "block.port" of what is asked of the pair, by the names under which they are asked for; live, `asked` is
        the robot's.
    strips : sequence of (name, signals, unit)
    """

    def __init__(
        self, made: OnPair, asked: Mapping[str, str], strips: Sequence[tuple[str, tuple[str, ...], str]]
    ) -> None:
        self._made = made
        block = "seen" if made.is_live else "pair"
        self.sources = {**asked, **{name: f"{block}.{name}" for name in MEASURED}}
        axes = made.axes if made.is_live else [""]
        self._strips = [
            Strip(name, unit, parts, [f"{part} {axis}".strip() for part in parts for axis in axes])
            for name, parts, unit in strips
        ]

    def gauges(self, watch: Watch) -> Iterator[Gauge]:
        """Give the control signal and the micro manipulator's position; live, what is asked of robot and stage."""
        if not self._made.is_live:
            yield from self._of_a_simulation(watch)
        elif (pair := self._made.pair) is not None:
            yield from self._of_a_live_pair(watch, pair)

    def lately(self, watch: Watch) -> Iterator[tuple[str, Panel]]:
        """Draw the last seconds."""
        return strips_of(watch, self._strips)

    def after(self, part: str, path: Path) -> Mapping[str, Panel]:
        """Return nothing."""
        return {}

    def _of_a_simulation(self, watch: Watch) -> Iterator[Gauge]:
        """Give the control signal, which is the output, and the micro manipulator's position; 0 while at rest."""
        control = watch.newest("control")
        most = self._made.config.inner.limit
        signal = 0.0 if control is None else float(control[0])
        yield Gauge("control", "Control signal of the micro manipulator", signal, "m/s", -most, most, is_output=True)
        yield from self._micro(watch, ("",))
        yield from timed(watch)

    def _of_a_live_pair(self, watch: Watch, pair: LivePair) -> Iterator[Gauge]:
        """Give the speed that the robot is asked for and whether the stage is led, which are the output, and more."""
        axes = self._made.axes
        now, before = watch.newest("asked"), watch.newest("asked", back=1)
        speed = 0.0 if now is None or before is None else float(np.linalg.norm(now - before)) * LOOKS
        most = self._made.cell.limits.tool_speed
        yield Gauge("tool_speed", "Reference of the tool speed", speed, "m/s", high=most, is_output=True)
        control, limit = watch.newest("control"), self._made.config.inner.limit
        for axis, signal in zip(axes, () if control is None else control.tolist(), strict=False):
            yield Gauge(f"control_{axis}", f"Control signal of the stage, {axis}", signal, "m/s", -limit, limit)
        yield from self._micro(watch, axes)
        yield from linked(pair.stage)

    def _micro(self, watch: Watch, axes: Sequence[str]) -> Iterator[Gauge]:
        fast, pair = watch.newest("fast"), self._made.config.pair
        for axis, at in zip(axes, () if fast is None else fast.tolist(), strict=False):
            name, title = (f"micro_{axis}", f"Micro manipulator, {axis}") if axis else ("micro", "Micro manipulator")
            yield Gauge(name, f"{title}, from its middle", at - pair.middle, "m", -pair.travel, pair.travel)
