"""The sensor check: the first block behind the sensors, which lets no value in that cannot be."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.config import Sensors
from stagectl.stage import sensors_kernel as kernel

_SENSORS = ("position", "extension")
_WRONG = ("", "is not a number", "is out of its range", "jumps", "is stuck")


@dataclass(frozen=True)
class SensorFault:
    """What a sensor did that it cannot do.

    Parameters
    ----------
    kind : int
        Of `sensors_kernel`: FINITE, RANGE, JUMP or STUCK.
    sensor : str
        "position" or "extension".
    axis : int, counted from 0
    sample : int, samples since `prepare`
    value, low, high : float, m
        What it showed, and what it could have; of a sensor that is stuck, `high` is the samples it may repeat itself.
    """

    kind: int
    sensor: str
    axis: int
    sample: int
    value: float
    low: float
    high: float

    def __str__(self) -> str:
        """Say it in one line."""
        text = f"{self.sensor} {self.axis + 1} {_WRONG[self.kind]} at sample {self.sample}: {self.value:.6g} m"
        if self.kind == kernel.FINITE:
            return text
        if self.kind == kernel.STUCK:
            return f"{text} for {self.high:.0f} samples"
        return f"{text}, must be {self.low:.6g} to {self.high:.6g} m"


class SensorCheck(Block):
    """Let sensors through, hold the last right value for a few wrong samples, and latch a fault when they last.

    Wrong is: no number, out of range, further from the last right value than the stage can move in that time.  A sensor
    that repeats itself to the last bit for `Sensors.stuck` is at fault at once.

    Ports, one wide an axis: `position`, `extension` (m) in; `valid_position`, `valid_extension` (m) out, and `fault`
    (one wide), which is 0 until something latches.

    Parameters
    ----------
    sensors : Sensors
    axes : int, >= 1
    """

    def __init__(self, sensors: Sensors, axes: int) -> None:
        self.inputs = (Port("position", "m", axes), Port("extension", "m", axes))
        self.outputs = (Port("valid_position", "m", axes), Port("valid_extension", "m", axes), Port("fault"))
        self._sensors = sensors
        self._bounds = np.zeros(2, kernel.BOUNDS)
        self._memory = np.zeros((2, axes), kernel.MEMORY)
        self._latch = np.zeros(1, kernel.LATCH)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen, and count samples from zero.  A latch survives: only `clear` ends it."""
        sensors = self._sensors
        for row, (low, high), speed in (
            (0, sensors.position, sensors.position_speed),
            (1, sensors.extension, sensors.extension_speed),
        ):
            self._bounds[row] = low, high, speed / rate, max(1, round(sensors.stuck * rate)), sensors.tolerated
        self._forget()
        self._latch["count"] = self._latch["held"] = 0

    def process(
        self,
        position: np.ndarray,
        extension: np.ndarray,
        valid_position: np.ndarray,
        valid_extension: np.ndarray,
        fault: np.ndarray,
    ) -> None:
        """Check one frame."""
        kernel.run(position, extension, valid_position, valid_extension, fault, self._bounds, self._memory, self._latch)

    def clear(self) -> None:
        """Forget the fault (between ticks); if it is there still, it latches again."""
        self._latch["kind"] = kernel.NONE
        self._forget()

    def _forget(self) -> None:
        middle = (self._bounds["low"] + self._bounds["high"]) / 2
        self._memory["good"], self._memory["raw"] = middle[:, np.newaxis], np.nan
        self._memory["repeats"] = self._memory["wrong"] = self._memory["seen"] = 0

    @property
    def fault(self) -> SensorFault | None:
        """What latched, or None."""
        kind, sensor, axis, sample, value, low, high, _, _ = self._latch[0].tolist()
        return SensorFault(kind, _SENSORS[sensor], axis, sample, value, low, high) if kind != kernel.NONE else None

    @property
    def held(self) -> int:
        """How many wrong samples were held off since `prepare`."""
        return int(self._latch["held"][0])
