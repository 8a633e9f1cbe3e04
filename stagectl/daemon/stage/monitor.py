"""What the stage does now: the last second's errors, and the newest positions and voltages, for whoever looks."""

from collections.abc import Iterator

import numpy as np

from ctlblocks.block import Block
from rigkit.service.show import Gauge
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import ports_of
from stagectl.experiments.piezo.setup import Setup
from stagectl.tracking import WITHIN

WINDOW = 1.0
"""s of errors that are kept."""


class Monitor(Block):
    """Keep what a page shows of a run; another thread may look at any time.

    Ports, one wide an axis: `reference`, `position` (m) and `voltage` (V) in.

    Parameters
    ----------
    made : Setup

    Attributes
    ----------
    seen : int, samples since `prepare`
    held : int, samples
        Of those, that the reference was held; whoever holds it says so.
    position : array, shape (axes,), m
    voltage : array, shape (axes,), V
    """

    def __init__(self, made: Setup) -> None:
        axes = made.config.stage.axes
        self.inputs = ports_of(("reference", "position", "voltage"), axes)
        self.seen = self.held = 0
        self.position, self.voltage = np.full((2, len(axes)), np.nan)
        self._proper = made.timeline.proper
        self._kept = 0
        self._error = np.zeros((1, len(axes)))

    def prepare(self, rate: float, frames: int) -> None:
        """Forget everything."""
        self.seen = self.held = self._kept = 0
        self._error = np.zeros((max(round(WINDOW * rate), frames), len(self.position)))
        self.position.fill(np.nan)
        self.voltage.fill(np.nan)

    def process(self, reference: np.ndarray, position: np.ndarray, voltage: np.ndarray) -> None:
        """Look at one frame; its error counts within the run proper."""
        frames = len(reference)
        if self._proper.start <= self.seen - self.held < self._proper.stop:
            start = self._kept % len(self._error)
            first = min(frames, len(self._error) - start)
            np.subtract(reference[:first], position[:first], out=self._error[start : start + first])
            np.subtract(reference[first:], position[first:], out=self._error[: frames - first])
            self._kept += frames
        self.seen += frames
        self.position[:] = position[-1]
        self.voltage[:] = voltage[-1]

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
