"""Clients that hold connections and ask for nothing: silent ones, and such as say a byte at a time."""

import selectors
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

PACE = 0.5
"""s between two bytes."""
KINDS = (
    (b"", b""),
    (b"", b"GET / HTTP/1.1\r\nHost: HOST\r\nX-Slow: " + 1000 * b"x"),
    (b"POST /api/begin HTTP/1.1\r\nHost: HOST\r\nContent-Length: 60000\r\n\r\n", 1000 * b"{"),
    (b"GET /nowhere HTTP/1.1\r\nHost: HOST\r\n\r\n", b""),
)
"""What is sent at once and what byte by byte: silence, a head, a body, and a request after which nothing comes."""


class SlowClients:
    """So many of them; one that is cut off comes again.

    Parameters
    ----------
    address : tuple of str, int
    many : int
    """

    def __init__(self, address: tuple[str, int], many: int) -> None:
        self._address, self._many = address, many
        self._host = f"{address[0]}:{address[1]}".encode()
        self._over = threading.Event()
        self._chooser = selectors.DefaultSelector()
        self._drips: dict[socket.socket, bytes] = {}
        self.cut_off = 0
        self._thread = threading.Thread(target=self._run)

    @property
    def connected(self) -> int:
        return len(self._drips)

    def _run(self) -> None:
        due = time.monotonic()
        while not self._over.is_set():
            while len(self._drips) < self._many:
                self._come(len(self._drips))
            for key, _ in self._chooser.select(0.01):
                self._hear(key.fileobj)  # type: ignore[arg-type]
            if time.monotonic() >= due:
                due = time.monotonic() + PACE
                for line in list(self._drips):
                    self._say(line)

    def _come(self, number: int) -> None:
        at_once, drip = (part.replace(b"HOST", self._host) for part in KINDS[number % len(KINDS)])
        line = socket.create_connection(self._address)
        line.setblocking(False)
        self._chooser.register(line, selectors.EVENT_READ)
        self._drips[line] = drip
        if at_once:
            line.send(at_once)

    def _say(self, line: socket.socket) -> None:
        if drip := self._drips[line]:
            try:
                line.send(drip[:1])
            except OSError:
                self._go(line)
            else:
                self._drips[line] = drip[1:]

    def _hear(self, line: socket.socket) -> None:
        try:
            gone = line in self._drips and not line.recv(65_536)
        except BlockingIOError:
            return
        except OSError:
            gone = True
        if gone:
            self.cut_off += 1
            self._go(line)

    def _go(self, line: socket.socket) -> None:
        self._chooser.unregister(line)
        del self._drips[line]
        line.close()

    def start(self) -> None:
        self._thread.start()

    def end(self) -> None:
        self._over.set()
        self._thread.join()
        for line in list(self._drips):
            self._go(line)
        self._chooser.close()


@contextmanager
def slow_clients(address: tuple[str, int], many: int) -> Iterator[SlowClients]:
    """Let so many hold connections during a block."""
    made = SlowClients(address, many)
    made.start()
    try:
        yield made
    finally:
        made.end()
