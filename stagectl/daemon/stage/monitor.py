"""What the stage does now: the last second's errors, and the newest positions and voltages, for whoever looks."""

from collections.abc import Callable, Iterator

import numpy as np

from ctlblocks.block import Block
from rigkit.service.show import Gauge
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import ports_of
from stagectl.experiments.piezo.figures import wanted_name
from stagectl.experiments.piezo.lasers import reads_laser
from stagectl.experiments.piezo.setup import Setup
from stagectl.tracking import WITHIN

WINDOW = 1.0
"""s of errors that are kept."""


class Monitor(Block):
    """Keep what a page shows of a run; another thread may look at any time.

    Ports, one wide an axis: `reference`, `position` (m) and `voltage` (V) in, and `absolute` (m) where a laser is read.
    Where the robot's deflection is compensated the error is the tool's: where it is wanted less what the laser sees;
    that is `wanted` (m) of a stage in process, in place of `reference`.

    Parameters
    ----------
    made : Setup
    held : callable() -> int, samples
        That the reference was held so far.

    Attributes
    ----------
    seen : int, samples since `prepare`
    position, absolute : array, shape (axes,), m
    voltage : array, shape (axes,), V
    """

    def __init__(self, made: Setup, held: Callable[[], int] = int) -> None:
        config, axes = made.config, made.config.stage.axes
        self._measured = 1
        signals = ["reference", "position", "voltage"] + ["absolute"] * reads_laser(config)
        if config.deflection.on:
            signals[0], self._measured = wanted_name(made), signals.index("absolute")
        self.inputs = ports_of(signals, axes)
        self.seen, self._held = 0, held
        self.position, self.voltage, self.absolute = np.full((3, len(axes)), np.nan)
        self._proper = made.timeline.proper
        self._kept = 0
        self._error = np.zeros((1, len(axes)))

    def prepare(self, rate: float, frames: int) -> None:
        """Forget everything."""
        self.seen = self._kept = 0
        self._error = np.zeros((max(round(WINDOW * rate), frames), len(self.position)))
        self.position.fill(np.nan)
        self.voltage.fill(np.nan)
        self.absolute.fill(np.nan)

    def process(self, *signals: np.ndarray) -> None:
        """Look at one frame; its error counts within the run proper."""
        reference, measured = signals[0], signals[self._measured]
        frames = len(reference)
        if self._proper.start <= self.seen - self._held() < self._proper.stop:
            start = self._kept % len(self._error)
            first = min(frames, len(self._error) - start)
            np.subtract(reference[:first], measured[:first], out=self._error[start : start + first])
            np.subtract(reference[first:], measured[first:], out=self._error[: frames - first])
            self._kept += frames
        self.seen += frames
        self.position[:] = signals[1][-1]
        self.voltage[:] = signals[2][-1]
        if len(signals) > 3:
            self.absolute[:] = signals[3][-1]

    def error(self) -> np.ndarray:
        """Return the errors of the last second of the run proper, oldest first, shape (samples, axes), m; a copy."""
        kept, most = self._kept, len(self._error)
        return self._error[:kept].copy() if kept <= most else np.roll(self._error, -(kept % most), axis=0)


def tracked(config: StageConfig, monitor: Monitor) -> Iterator[Gauge]:
    """Give how well a run follows."""
    error = monitor.error()
    mean = np.abs(error).mean(axis=0).tolist() if len(error) else [None] * len(config.stage.axes)
    for axis, value in zip(config.stage.axes, mean, strict=True):
        yield Gauge(f"mae_{axis}", f"Mean absolute error {axis}, last second", value, "m", high=WITHIN)


def seen_by_laser(config: StageConfig, monitor: Monitor) -> Iterator[Gauge]:
    """Give where lasers see the tool, and by how much the robot gives way, where they are read."""
    if not reads_laser(config):
        return
    seen, deflection = monitor.absolute.tolist(), (monitor.absolute - monitor.position).tolist()
    for axis, place, given in zip(config.stage.axes, seen, deflection, strict=True):
        yield Gauge(f"absolute_{axis}", f"Tool {axis}, by laser", place, "m")
        yield Gauge(f"deflection_{axis}", f"Deflection {axis} of the robot", given, "m")
