"""The force sensor's records as they come over its wire, one for each report of the robot, for a graph that judges."""

from collections import deque
from math import ceil

import numpy as np

from stagectl.robot.force_config import ForceSensor
from stagectl.robot.force_inbox import ForceCounts, is_saturated
from stagectl.wire.force_sensor import Record
from stagectl.wire.makes import FORCE_SENSORS
from stagectl.wire.robot import RATE
from stagectl.wire.sequence import Sequence

_PAUSE = 0.25
"""s of this program that are caught up with report by report."""
_KEPT = 4_096
"""Records that wait for a reader that stands still; older ones are lost."""


class ForceRecords:
    """Keeps the records of a `ForceStream` until they are asked for, and judges nothing.

    Parameters
    ----------
    sensor : ForceSensor

    Attributes
    ----------
    seen : float, s, when the last record came
    """

    def __init__(self, sensor: ForceSensor) -> None:
        self.sensor, self.counts, self.seen = sensor, ForceCounts(), -np.inf
        self._records: deque[Record] = deque(maxlen=_KEPT)
        self._sequence = Sequence(FORCE_SENSORS[sensor.wire]().modulus)

    def accept(self, record: Record, now: float) -> None:
        """Take a record that has come at `now` (s)."""
        self._records.append(record)
        self.seen = now

    def watch(self, now: float) -> None:
        """Nothing hangs on its being there in time: who judges the records does."""

    def lose(self) -> None:
        """Take the next record as the first: the box has begun anew."""
        self._sequence.reset()

    def skip(self) -> None:
        """Forget what waits."""
        self._records.clear()
        self._sequence.reset()

    def take(self) -> tuple[Record, int] | None:
        """Return what has come for a report of the robot as one record, and how many are missing before it, or None.

        It is their mean; one that is saturated or faulty is not hidden by others and stands for all.  Where more wait,
        as after a pause of this program, they are for the reports that wait, too; of very many none is kept back.
        """
        found, missing = [], 0
        share = ceil(self.sensor.rate / RATE)
        for _ in range(len(self._records) if len(self._records) > _PAUSE * self.sensor.rate else share):
            if not self._records:
                break
            record = self._records.popleft()
            lost = self._sequence.accept(record.counter)
            if lost >= 0:
                found.append(record)
                missing += lost
        if not found:
            return None
        bad = [each for each in found if each.status or is_saturated(each, self.sensor)]
        if bad:
            return bad[-1], missing
        last = found[-1]
        mean = np.mean([each.wrench for each in found], axis=0)
        return Record(last.counter, last.sample, last.status, mean), missing
