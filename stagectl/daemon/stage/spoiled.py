"""Faults on purpose between the simulated stage's sensors and what looks at them."""

import numpy as np

from ctlblocks import Graph
from ctlblocks.block import Block
from rigkit.faults import Faults, FaultTable
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import Seen, ports_of

_SENSORS = ("position", "extension")


def sensor_names(config: StageConfig) -> tuple[str, ...]:
    """Return what can be spoiled: position_x and so on, then extension_x and so on."""
    return tuple(f"{sensor}_{axis}" for sensor in _SENSORS for axis in config.stage.axes)


class SpoiledSensors(Block):
    """Pass the stage's sensors on, with the faults that a table says.

    Ports, one wide an axis: `position`, `extension` (m) in; `shown_position`, `shown_extension` (m) out, and the same
    as `kept_position`, `kept_extension`: a recording holds numbers only, so what is none stands there as far beyond
    the sensor's range as that is wide, which the sensor check takes as badly.

    Parameters
    ----------
    table : FaultTable
        Of `sensor_names`.
    config : StageConfig
    """

    def __init__(self, table: FaultTable, config: StageConfig) -> None:
        axes = config.stage.axes
        self.inputs = ports_of(_SENSORS, axes)
        self.outputs = ports_of([f"{kind}_{sensor}" for kind in ("shown", "kept") for sensor in _SENSORS], axes)
        limits = np.repeat([config.sensors.position, config.sensors.extension], len(axes), axis=0)
        self._faults = Faults(table, limits[:, 1].tolist(), "m")
        self._beyond = 2 * limits[:, 1] - limits[:, 0]
        self._axes = len(axes)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what came before."""
        self._faults.prepare(rate, frames)
        self._clean, self._faulty = np.zeros((2, frames, 2 * self._axes))
        self._wrong = np.zeros(self._faulty.shape, bool)

    def process(
        self,
        position: np.ndarray,
        extension: np.ndarray,
        shown_position: np.ndarray,
        shown_extension: np.ndarray,
        kept_position: np.ndarray,
        kept_extension: np.ndarray,
    ) -> None:
        """Spoil one frame."""
        axes, faulty, wrong = self._axes, self._faulty, self._wrong
        self._clean[:, :axes] = position
        self._clean[:, axes:] = extension
        self._faults.process(self._clean, faulty)
        shown_position[:] = faulty[:, :axes]
        shown_extension[:] = faulty[:, axes:]
        np.isfinite(faulty, out=wrong)
        np.logical_not(wrong, out=wrong)
        np.copyto(faulty, self._beyond, where=wrong)
        kept_position[:] = faulty[:, :axes]
        kept_extension[:] = faulty[:, axes:]


def spoiled(seen: Seen, table: FaultTable, config: StageConfig) -> Seen:
    """Return what adds a stage, and faults behind its sensors; what is recorded of them is finite."""

    def through(graph: Graph) -> dict[str, tuple[str, bool]]:
        outputs = seen(graph)
        graph.add("spoiled", SpoiledSensors(table, config))
        for sensor in _SENSORS:
            source, delayed = outputs[sensor]
            graph.connect(source, f"spoiled.{sensor}", delayed=delayed)
        shown = {sensor: (f"spoiled.shown_{sensor}", False) for sensor in _SENSORS}
        kept = {f"kept {sensor}": (f"spoiled.kept_{sensor}", False) for sensor in _SENSORS}
        return outputs | shown | kept

    return through
