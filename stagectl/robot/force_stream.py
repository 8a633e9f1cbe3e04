"""The stream of a force sensor's box: asked for, asked for again after a silence, and handed on record by record."""

from collections.abc import Callable
from typing import Protocol, Self

import numpy as np

from rigkit.wire.layout import GarbledError
from stagectl.link.bus import LinkError
from stagectl.link.robot_datagrams import Datagrams, resolved
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.force_inbox import ForceCounts
from stagectl.wire.force_sensor import ForceWire, Record
from stagectl.wire.makes import FORCE_SENSORS

_LOOK = 0.005
"""s without a datagram after which the thread looks at the time."""
_AGAIN = 0.5
"""s of silence after which the stream is asked for again: the box has been off, or the request was lost."""


class Inbox(Protocol):
    """What takes the records; called by the stream's thread alone."""

    seen: float
    counts: ForceCounts

    def accept(self, record: Record, now: float) -> None:
        """Take a record that has come at `now` (s)."""

    def watch(self, now: float) -> None:
        """Look at the time."""

    def lose(self) -> None:
        """Take the next record as the first: the stream begins anew."""


class _Talk:
    """Asks for the stream, and again after a silence; hands records on."""

    def __init__(self, inbox: Inbox, wire: ForceWire, counts: np.ndarray, now: Callable[[], float]) -> None:
        self.peer: tuple[str, int] | None = None
        self.inbox, self.is_over = inbox, False
        self._wire, self._counts, self._now, self._asked = wire, counts, now, -np.inf

    def take(self, data: bytes, sender: tuple[str, int], now: float) -> None:
        """Take a datagram of the box; others are not listened to."""
        if sender != self.peer:
            return
        try:
            records = self._wire.read(data, self._counts)
        except GarbledError:
            self.inbox.counts.garbled += 1
            return
        for record in records:
            self.inbox.accept(record, now)

    def give(self) -> bytes | None:
        """Return a request where one is due."""
        if self.is_over:
            return self._wire.stop
        now = self._now()
        if now - max(self._asked, self.inbox.seen) < _AGAIN:
            return None
        self._asked = now
        self.inbox.lose()
        return self._wire.start

    def watch(self, now: float) -> None:
        """Look at the time."""
        self.inbox.watch(now)

    def finish(self) -> None:
        """Ask for the end of the stream from now on."""
        self.is_over = True


class ForceStream:
    """The sensor's stream behind its box: a context manager that reads all the time.

    Parameters
    ----------
    sensor : ForceSensor
    inbox : Inbox
    now : callable() -> float, s, a monotonic clock
    patience : float, s, for the first record

    Raises
    ------
    LinkError : on entry, when its host is not known, or nothing comes within `patience`.
    """

    def __init__(self, sensor: ForceSensor, inbox: Inbox, now: Callable[[], float], patience: float) -> None:
        self._sensor, self._inbox, self._patience = sensor, inbox, patience
        self._talk = _Talk(inbox, FORCE_SENSORS[sensor.wire](), sensor.counts, now)
        self._carrier = Datagrams(sensor.listen, 0, self._talk, now, _LOOK, "force_sensor")

    def __enter__(self) -> Self:
        """Ask for the stream, and wait for it."""
        self._talk.peer = resolved(self._sensor.host, self._sensor.port, "force_sensor")
        self._carrier.open()
        if not self.until(lambda: self._inbox.seen > -np.inf, self._patience):
            self._carrier.close()
            host, port = self._sensor.host, self._sensor.port
            raise LinkError(f"the force sensor on {host}:{port} sends nothing within {self._patience:g} s")
        return self

    def __exit__(self, *_: object) -> None:
        """End the stream."""
        self._carrier.ask(self._talk.finish)
        self._carrier.close()

    def until(self, met: Callable[[], bool], seconds: float) -> bool:
        """Return whether `met` holds, as soon as something has come after which it does, or after `seconds`."""
        with self._carrier.arrived:
            return self._carrier.arrived.wait_for(met, seconds)
