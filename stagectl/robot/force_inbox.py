"""What is made of a force sensor's records: order, silence, saturation, zero force taken at rest, and drift since."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stagectl.robot.force_config import ForceSensor
from stagectl.wire.force_sensor import SATURATED, Record
from stagectl.wire.makes import FORCE_SENSORS
from stagectl.wire.sequence import Sequence

_NEARLY = 0.999
"""Of the range: as good as its end."""


@dataclass
class ForceCounts:
    """What became of the sensor's records.

    Parameters
    ----------
    received, lost, late, garbled, saturated : int
        Lost: missing before the next one; late: after their turn, or twice; garbled: datagrams that were none;
        saturated: at an end of the range, or said to be.
    """

    received: int = 0
    lost: int = 0
    late: int = 0
    garbled: int = 0
    saturated: int = 0


class ForceInbox:
    """Follows the wrench of one sensor.  Fed by one thread, read by others.

    While it rests (`rest` to `move`) the mean over `sensor.rest` is taken: the first time it is zero force from then
    on, later it shows how far the sensor has drifted.  It tells the first of its faults while it is watched (`begin` to
    `end`), by name: silent, saturated, faulty, drifted; a rest that is none is told as restless, watched or not.

    Parameters
    ----------
    sensor : ForceSensor
    tell : callable(reason)

    Attributes
    ----------
    wrench : array, shape (6,), N and N m, less zero force; NaN until one has come
    zero : array, shape (6,), N and N m; NaN until it is known
    drift : array, shape (6,), N and N m, at the last rest but the first
    seen : float, s, when the last good record came
    fault : str, its name; empty for none
    """

    def __init__(self, sensor: ForceSensor, tell: Callable[[str], None]) -> None:
        self.sensor, self.counts = sensor, ForceCounts()
        self.wrench, self.zero, self.drift = np.full(6, np.nan), np.full(6, np.nan), np.zeros(6)
        self.seen, self.fault = -np.inf, ""
        self.is_watched = self.is_resting = False
        self._sequence, self._tell = Sequence(FORCE_SENSORS[sensor.wire]().modulus), tell
        self._end: float | None = None
        self._rested: list[np.ndarray] = []
        self._since = np.inf

    @property
    def is_tared(self) -> bool:
        """Whether zero force is known."""
        return bool(np.isfinite(self.zero).all())

    @property
    def is_good(self) -> bool:
        """Whether the newest record counts: zero force is known, it is within its range, and no fault is latched."""
        return self.is_tared and self._end is None and not self.fault

    def accept(self, record: Record, now: float) -> None:
        """Take a record that has come at `now` (s)."""
        counts, sensor = self.counts, self.sensor
        counts.received += 1
        missing = self._sequence.accept(record.counter)
        if missing < 0:
            counts.late += 1
            return
        counts.lost += missing
        if is_saturated(record, sensor):
            counts.saturated += 1
            self._end = now if self._end is None else self._end
            self.seen = now
            if now - self._end >= sensor.saturated:
                self._fail("saturated", f"for {now - self._end:.3g} s: force {_three(record.wrench[:3])} N")
            return
        self._end = None
        if record.status:
            self._fail("faulty", f"status {record.status:#010x}")
            return
        zero = self.zero if self.is_tared else 0.0
        self.wrench, self.seen = record.wrench - zero, now  # a new array each time: a reader has the old or the new one
        if self.is_resting:
            self._rest(record.wrench, now)

    def watch(self, now: float) -> None:
        """Look how long it has been silent."""
        silent = now - self.seen
        if self.is_watched and not silent <= self.sensor.silence:
            self._fail("silent", f"for {silent:.3g} s, must be <= {self.sensor.silence:g} s")

    def lose(self) -> None:
        """Take the next record as the first: the box has begun anew."""
        self._sequence.reset()

    def begin(self, now: float) -> None:
        """Be watched from now on."""
        self.seen, self._end, self.fault, self.is_watched = max(self.seen, now), None, "", True

    def end(self) -> None:
        """Be watched no more."""
        self.is_watched = False

    def rest(self, now: float) -> None:
        """Take the tool for free and at rest from now on."""
        self._rested, self._since, self.is_resting = [], now, True

    def move(self) -> None:
        """Take it for moving, or touching, from now on."""
        self.is_resting = False

    def _rest(self, wrench: np.ndarray, now: float) -> None:
        self._rested.append(wrench)
        if now - self._since < self.sensor.rest:
            return
        sensor, seen = self.sensor, np.array(self._rested)
        self.is_resting = False
        noise = float(seen[:, :3].std(axis=0).max())
        if not noise <= sensor.noise:
            self._fail("restless", f"force varies by {noise:.3g} N rms, must be <= {sensor.noise:g} N", always=True)
            return
        if not self.is_tared:
            self.zero = seen.mean(axis=0)
            return
        self.drift = seen.mean(axis=0) - self.zero
        if np.any(np.abs(self.drift) > np.repeat([sensor.drift, sensor.drift_moment], 3)):
            self._fail(
                "drifted",
                f"at rest by {_three(self.drift[:3])} N, must be <= {sensor.drift:g} N, "
                f"and {_three(self.drift[3:])} N m, must be <= {sensor.drift_moment:g} N m",
                always=True,
            )

    def _fail(self, name: str, why: str, *, always: bool = False) -> None:
        """Latch a fault and tell it once; while it is not watched only where it `always` counts."""
        if self.fault or not (self.is_watched or always):
            return
        self.fault, self.is_watched = name, False
        self._tell(f"the force sensor {'has' if name == 'drifted' else 'is'} {name}: {why}")


def is_saturated(record: Record, sensor: ForceSensor) -> bool:
    """Whether a record is at an end of the range, or says so."""
    return bool(record.status & SATURATED or np.any(np.abs(record.wrench) >= _NEARLY * sensor.range))


def _three(values: np.ndarray) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
