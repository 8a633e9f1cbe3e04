"""The force sensor within a graph: its records judged as those over UDP are, in graph time."""

from collections.abc import Callable

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.force_inbox import ForceCounts, ForceInbox
from stagectl.wire.force_sensor import Record


class WiredForce(Block):
    """Follow the force, take zero force and drift at rest, and hold the robot on a fault.

    Ports: of the sensor `sample` (1), its counter, `status` (1) and `measured` (1, 6: N and N m), and `resting`, 1
    while the tool is free and at rest, in; `force` (N, 3) and `moment` (N m, 3) less zero force, their `age` (s), and
    `valid`, 1 where they count, out; zero until a record has come.

    Parameters
    ----------
    sensor : ForceSensor
    hold : callable(reason)
        Such as `WiredPort.hold`.
    """

    inputs = (Port("sample"), Port("status"), Port("measured", "1", 6), Port("resting"))
    outputs = (Port("force", "N", 3), Port("moment", "N m", 3), Port("age", "s"), Port("valid"))

    def __init__(self, sensor: ForceSensor, hold: Callable[[str], None]) -> None:
        self.sensor, self._hold = sensor, hold

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen."""
        self.inbox = ForceInbox(self.sensor, self._hold)
        self._rate, self._done, self._sample, self._rests = rate, 0, 0.0, False

    def process(
        self,
        sample: np.ndarray,
        status: np.ndarray,
        measured: np.ndarray,
        resting: np.ndarray,
        force: np.ndarray,
        moment: np.ndarray,
        age: np.ndarray,
        valid: np.ndarray,
    ) -> None:
        """Judge, sample by sample."""
        inbox = self.inbox
        for n in range(len(sample)):
            self._done += 1
            now = self._done / self._rate
            if (resting[n, 0] >= 1.0) != self._rests:
                self._rests = not self._rests
                if self._rests:
                    inbox.rest(now)
                else:
                    inbox.move()
            if sample[n, 0] > self._sample:
                self._sample = float(sample[n, 0])
                inbox.accept(Record(int(self._sample), int(self._sample), int(status[n, 0]), measured[n].copy()), now)
            inbox.watch(now)
            is_seen = inbox.seen > -np.inf
            force[n], moment[n] = (inbox.wrench[:3], inbox.wrench[3:]) if is_seen else (0.0, 0.0)
            age[n, 0] = now - max(inbox.seen, 0.0)
            valid[n, 0] = inbox.is_good and age[n, 0] <= self.sensor.silence

    def start(self) -> None:
        """Be watched from now on (between ticks)."""
        self.inbox.begin(self._done / self._rate)

    @property
    def counts(self) -> ForceCounts:
        """What became of the records."""
        return self.inbox.counts
