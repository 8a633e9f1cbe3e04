"""The laser check: the first block behind the lasers, which lets no reading in that is stale, stuck or impossible."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.stage import laser_check_kernel as kernel

TOLERATED = 2
"""Invalid readings in a row for which the last valid one is held."""
CYCLES = 3
"""Of a laser that its newest reading may be old: one when it comes, two before the next, and one may be lost."""
_WRONG = ("", "is stale", "is stuck", "is out of its range", "jumps")


@dataclass(frozen=True)
class LaserLimits:
    """What the stage's lasers can show.

    Parameters
    ----------
    rate : float, Hz, readings a second
    late : float, s, by which a reading may be older than `CYCLES` cycles
    stuck : float, readings that may be the same number
    speed : float, m/s, fastest change
    """

    rate: float
    late: float
    stuck: float
    speed: float

    @property
    def oldest(self) -> float:
        """Greatest age of a reading, s."""
        return CYCLES / self.rate + self.late


@dataclass(frozen=True)
class LaserFault:
    """What a laser did that it cannot do.

    Parameters
    ----------
    kind : int
        Of `laser_check_kernel`: STALE, STUCK, RANGE or JUMP.
    axis : int, counted from 0
    value : float, m, its newest reading
    age : float, s, of its newest valid reading
    """

    kind: int
    axis: int
    value: float
    age: float

    def __str__(self) -> str:
        """Say it in one line."""
        return f"laser {self.axis + 1} {_WRONG[self.kind]}: {self.value:.6g} m, {1e3 * self.age:.3g} ms old"


class LaserCheck(Block):
    """Let readings through, hold the last valid one for `TOLERATED` invalid ones, and latch a fault when they last.

    A reading is new when its age has not grown since the sample before.  It is invalid when it is no number, out of
    range, or further from the last valid one than `LaserLimits.speed` allows between
    two readings.  The same number again and again, and a
    valid reading older than `LaserLimits.oldest`, are faults at once.

    Ports, one wide an axis: `reading` (m), `age` (s) in; `valid` (m), `valid_age` (s) out, and `fault` (one wide),
    which is 0 until something latches.

    Parameters
    ----------
    limits : LaserLimits
    origin, largest : float, m
        Readings are within `largest` of `origin`.
    axes : int, >= 1
    """

    def __init__(self, limits: LaserLimits, origin: float, largest: float, axes: int) -> None:
        self.inputs = (Port("reading", "m", axes), Port("age", "s", axes))
        self.outputs = (Port("valid", "m", axes), Port("valid_age", "s", axes), Port("fault"))
        self.limits = limits
        self._bounds = np.zeros(1, kernel.BOUNDS)
        self._bounds["origin"], self._bounds["largest"], self._bounds["tolerated"] = origin, largest, TOLERATED
        self._memory, self._latch = np.zeros(axes, kernel.MEMORY), np.zeros(1, kernel.LATCH)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen."""
        self._bounds["period"] = 1.0 / rate
        self.change(self.limits)

    def process(
        self, reading: np.ndarray, age: np.ndarray, valid: np.ndarray, valid_age: np.ndarray, fault: np.ndarray
    ) -> None:
        """Check one frame."""
        kernel.run(reading, age, valid, valid_age, fault, self._bounds, self._memory, self._latch)

    def change(self, limits: LaserLimits) -> None:
        """Take other limits (between ticks), and forget what was seen and what has latched."""
        self.limits = limits
        bounds = self._bounds
        bounds["oldest"], bounds["stuck"], bounds["speed"] = limits.oldest, limits.stuck, limits.speed
        self.clear()

    def clear(self) -> None:
        """Forget the fault (between ticks); if it is there still, it latches again."""
        self._memory[:] = np.zeros(1, kernel.MEMORY)
        self._memory["raw"], self._memory["raw_age"] = np.nan, np.inf
        self._latch[:] = np.zeros(1, kernel.LATCH)

    @property
    def fault(self) -> LaserFault | None:
        """What latched, or None."""
        kind, axis, value, age, *_ = self._latch[0].item()
        return None if kind == kernel.NONE else LaserFault(kind, axis, value, age)

    @property
    def held(self) -> int:
        """How many invalid readings were held off since `prepare` or `clear`."""
        return int(self._latch["held"][0])

    def greatest_age(self) -> float:
        """Return the greatest age of a valid reading, s, since this was last asked."""
        greatest = float(self._latch["greatest"][0])
        self._latch["greatest"] = 0.0
        return greatest
