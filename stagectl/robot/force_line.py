"""The force sensor at the wrist: its line, zero force and drift at rest, and the force as a Block."""

import time
from collections.abc import Callable
from typing import Self

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.link.bus import LinkError
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.force_inbox import ForceCounts, ForceInbox
from stagectl.robot.force_stream import ForceStream


class ForceLine:
    """The sensor behind its box: a context manager that streams all the time, and is watched from `start` to `stop`.

    Parameters
    ----------
    sensor : ForceSensor
    hold : callable(reason)
        Called once when it is silent, saturated, faulty or has drifted, such as `RobotPort.hold`.
    now : callable() -> float, s, a monotonic clock
    patience : float, s, for the first record, and beyond `sensor.rest` for a rest

    Raises
    ------
    LinkError : on entry, when its host is not known, or nothing comes within `patience`.
    """

    def __init__(
        self,
        sensor: ForceSensor,
        hold: Callable[[str], None],
        now: Callable[[], float] = time.monotonic,
        patience: float = 2.0,
    ) -> None:
        self.sensor, self.inbox, self.reason = sensor, ForceInbox(sensor, self._fail), ""
        self._hold, self._now, self._patience = hold, now, patience
        self._stream = ForceStream(sensor, self.inbox, now, patience)

    def __enter__(self) -> Self:
        """Ask for the stream, and wait for it."""
        self._stream.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        """End the stream."""
        self.stop()
        self._stream.__exit__()

    @property
    def counts(self) -> ForceCounts:
        """What became of its records."""
        return self.inbox.counts

    @property
    def age(self) -> float:
        """How long ago a record came, s."""
        return self._now() - self.inbox.seen

    def start(self) -> None:
        """Be watched: from now on a fault holds the robot."""
        self.inbox.begin(self._now())

    def stop(self) -> None:
        """Be watched no more."""
        self.inbox.end()

    def rest(self) -> np.ndarray:
        """Take zero force, the first time, and the drift since then, later: the tool is free and at rest.

        Returns
        -------
        array, shape (6,), N and N m, the drift; nothing the first time

        Raises
        ------
        LinkError : it does not rest, or has drifted, or too little comes.
        """
        done = self.inbox.rests
        self.inbox.fault = self.reason = ""
        self._stream.ask(lambda: self.inbox.rest(self._now()))
        self._stream.until(lambda: bool(self.reason) or self.inbox.rests > done, self._patience + self.sensor.rest)
        self.inbox.move()
        if self.reason or self.inbox.rests == done:
            raise LinkError(self.reason or f"the force sensor sends no {self.sensor.rest:g} s of records at rest")
        return self.inbox.drift.copy()

    def _fail(self, reason: str) -> None:
        self.reason = reason
        self._hold(reason)


class MeasuredForce(Block):
    """Hold the newest wrench: `force` (N, 3), `moment` (N m, 3), its `age` (s), and `valid`, 1 where it counts, out.

    It counts once zero force is known, while it is within its range, no older than `silence`, and no fault is latched;
    NaN until a record has come.

    Parameters
    ----------
    line : ForceLine
    """

    outputs = (Port("force", "N", 3), Port("moment", "N m", 3), Port("age", "s"), Port("valid"))

    def __init__(self, line: ForceLine) -> None:
        self.line = line

    def process(self, force: np.ndarray, moment: np.ndarray, age: np.ndarray, valid: np.ndarray) -> None:
        """Fill one frame."""
        inbox, old = self.line.inbox, self.line.age
        wrench = inbox.wrench
        force[:], moment[:] = wrench[:3], wrench[3:]
        age.fill(old)
        valid.fill(inbox.is_good and old <= inbox.sensor.silence)
