"""Carries frames between the bus and the conversation: a thread that listens and a thread that speaks."""

import contextlib
from collections.abc import Callable
from threading import Condition, Event, Thread
from typing import Any

from rigkit.machine_lock import MachineLock
from rigkit.priority import real_time
from stagectl.link.bus import LinkDown, LinkError, bus_lock, message, open_bus
from stagectl.link.config import Link
from stagectl.link.conversation import Conversation
from stagectl.wire.messages import PERIOD, HostState

_LISTEN = 0.02
"""s without a frame after which the listening thread looks up."""
_RETRY = 0.2
"""s between attempts to open an adapter that has gone, and for a frame to be taken by it."""
_LONGEST_END = 2.0
"""s for a thread to end; one that hangs in a driver dies with the program."""


class Carrier:
    """Owns the bus.  When its adapter goes it says so, and opens it again as soon as it is back.

    Parameters
    ----------
    link : Link
    conversation : Conversation
    now : callable() -> float, s, a monotonic clock
    """

    def __init__(self, link: Link, conversation: Conversation, now: Callable[[], float]) -> None:
        self.arrived = Condition()
        self._link, self._conversation, self._now = link, conversation, now
        self._bus: Any = None
        self._lock: MachineLock | None = None
        self._garbled = 0
        self._over, self._wake = Event(), Event()
        works = (self._listen, self._speak)
        self._threads = [Thread(target=self._in_time, args=(work,), name=work.__name__, daemon=True) for work in works]

    @property
    def garbled(self) -> int:
        """Lines from the adapter that were no frame."""
        return self._garbled + getattr(self._bus, "garbled", 0)

    @property
    def is_up(self) -> bool:
        """Whether the adapter is there."""
        return self._bus is not None

    def open(self) -> None:
        """Open the bus and begin; LinkError where it cannot be opened."""
        self._lock = bus_lock(self._link)
        try:
            self._bus = open_bus(self._link)
        except BaseException:
            self._release()
            raise
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """End both threads, after a last word, and close the bus."""
        self._over.set()
        self._wake.set()
        for thread in self._threads:
            thread.join(_LONGEST_END)
        self._close_bus()
        self._release()

    def _release(self) -> None:
        if self._lock is not None:
            self._lock.release()
            self._lock = None

    def flush(self) -> None:
        """Have what waits sent now."""
        self._wake.set()

    def _in_time(self, work: Callable[[], None]) -> None:
        with real_time():
            work()

    def _listen(self) -> None:
        while not self._over.is_set():
            bus = self._bus
            if bus is None:
                self._reopen()
                continue
            heard = self._now()
            try:
                received = bus.recv(_LISTEN)
                heard = self._now()  # what came until now has been read when we look at the time
                while received is not None:
                    self._conversation.take(received.arbitration_id, bytes(received.data), self._now())
                    received = bus.recv(0.0)
            except ValueError:  # python-can's own slcan, of a line that is no frame
                self._garbled += 1
            except (*LinkDown, TypeError) as fault:  # TypeError: pyserial, of a port closed by the other thread
                if self._bus is bus:  # else the other thread has closed it, and says why
                    self._lose(f"the adapter {self._link.channel} has gone: {fault}")
            self._conversation.watch(heard)
            if self._conversation.reason:
                self._wake.set()
            with self.arrived:
                self.arrived.notify_all()

    def _speak(self) -> None:
        conversation = self._conversation
        while not self._over.is_set():
            wait = max(conversation.due - self._now(), 0.0)
            self._wake.wait(min(wait, PERIOD) if conversation.state is HostState.STREAMING else wait)
            self._wake.clear()
            bus = self._bus
            frames = conversation.give(self._now())
            try:
                for identifier, data in frames if bus is not None else ():
                    bus.send(message(identifier, data), _RETRY)
            except (*LinkDown, TypeError) as fault:
                self._lose(f"the adapter {self._link.channel} does not send: {fault}")

    def _lose(self, reason: str) -> None:
        self._close_bus()
        if not self._over.is_set():
            self._conversation.lose(reason)

    def _close_bus(self) -> None:
        bus, self._bus = self._bus, None
        if bus is not None:
            self._garbled += getattr(bus, "garbled", 0)
            with contextlib.suppress(*LinkDown, TypeError):  # it may have gone already
                bus.shutdown()

    def _reopen(self) -> None:
        try:
            self._bus = open_bus(self._link)
        except LinkError:
            self._over.wait(_RETRY)
