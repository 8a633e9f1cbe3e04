"""Sends frames to a relay while the program is well; it has no way to say that it is not."""

import time
from collections.abc import Callable
from threading import Event, Thread

from rigkit.priority import real_time
from rigkit.relay.bus import Down, RelayBus, RelayError
from rigkit.relay.config import Relay
from rigkit.relay.frame import heartbeat

AGAIN = 0.2
"""s between attempts to open an adapter that has gone."""
_LONGEST_END = 2.0
"""s for the thread to end; one that hangs in a driver dies with the program."""

Pulse = Callable[[], int | None]


class Heartbeat:
    """A thread that sends a frame each period in which `pulse` has moved on, and none otherwise.

    A latched guard, a program that stands still, an adapter that has gone and a process that has ended are silence, all
    of them.  An adapter that is back is opened again.

    Parameters
    ----------
    relay : Relay
        Without a bus nothing is sent.
    pulse : callable() -> int or None
        A count that moves on while what the relay feeds is under control; None where it is not.  It is called from the
        thread, and waits for nothing.
    """

    def __init__(self, relay: Relay, pulse: Pulse) -> None:
        self._relay, self._pulse = relay, pulse
        self._frame = heartbeat(relay.identifier, relay.period)
        self.sent = 0
        """Frames that the adapter has taken."""
        self._bus: RelayBus | None = None
        self._closed_at = 0.0
        self._over = Event()
        self._thread: Thread | None = None

    def start(self) -> None:
        """Open the bus and begin.

        Raises
        ------
        RelayError : it cannot be opened.
        ValueError : there is no such class.
        """
        if not self._relay.bus:
            return
        self._bus = RelayBus(self._relay)
        self._thread = Thread(target=self._run, name="relay", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Send nothing more, and close the bus; once is enough."""
        self._over.set()
        if self._thread is not None:
            self._thread.join(_LONGEST_END)
            self._thread = None
        self._close()

    def _run(self) -> None:
        with real_time():
            began = due = time.monotonic()
            last: int | None = None
            while not self._over.wait(max(due - time.monotonic(), 0.0)):
                now = time.monotonic()
                due = max(due + self._relay.period, now)
                count = self._pulse()
                if None not in (count, last) and count != last:
                    self._send(round(1e3 * (now - began)) % 2**32)
                last = count

    def _send(self, milliseconds: int) -> None:
        bus = self._bus or self._reopened()
        if bus is None:
            return
        try:
            bus.pass_over()
            bus.send(self._frame.identifier, self._frame.pack(self.sent, milliseconds), self._relay.period)
            self.sent += 1
        except (*Down, TypeError):  # TypeError: pyserial, of a port that has gone
            self._close()

    def _reopened(self) -> RelayBus | None:
        if time.monotonic() - self._closed_at > AGAIN:
            self._closed_at = time.monotonic()
            try:
                self._bus = RelayBus(self._relay)
            except RelayError:
                return None
        return self._bus

    def _close(self) -> None:
        bus, self._bus, self._closed_at = self._bus, None, time.monotonic()
        if bus is not None:
            bus.close()
