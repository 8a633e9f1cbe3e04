"""Carries bytes from a TCP server beside the robot: a thread that connects, reads, and connects again."""

import contextlib
import socket
from collections.abc import Callable
from threading import Condition, Event, Thread
from typing import Protocol

from rigkit.priority import real_time
from stagectl.link.bus import LinkError

_RETRY = 0.2
"""s between attempts to connect."""
_LISTEN = 0.02
"""s without a byte after which the thread looks at the time."""
_LONGEST_END = 2.0
_LARGEST = 65_536


class Reader(Protocol):
    """What takes the bytes; called by the thread alone."""

    def take(self, data: bytes, now: float) -> None:
        """Take bytes as they have come."""

    def watch(self, now: float) -> None:
        """Look at the time; all that has come is taken."""

    def lose(self) -> None:
        """Hear that the line is down."""


class Stream:
    """Owns a TCP connection, and makes it again when it has gone.

    Parameters
    ----------
    host : str
    port : int
    reader : Reader
    now : callable() -> float, s, a monotonic clock
    """

    def __init__(self, host: str, port: int, reader: Reader, now: Callable[[], float]) -> None:
        self.arrived = Condition()
        self.is_up = False
        self._address, self._reader, self._now = (host, port), reader, now
        self._over = Event()
        self._thread = Thread(target=self._run, name=f"{host}:{port}", daemon=True)

    def open(self) -> None:
        """Begin to connect and read."""
        self._thread.start()

    def close(self) -> None:
        """End the thread and the connection."""
        self._over.set()
        if self._thread.is_alive():
            self._thread.join(_LONGEST_END)

    def _run(self) -> None:
        with real_time():  # one that waits for the interpreter's lock would make the robot's thread wait as well
            self._serve()

    def _serve(self) -> None:
        while not self._over.is_set():
            try:
                with socket.create_connection(self._address, _RETRY) as line:
                    self._read(line)
            except OSError:
                self._over.wait(_RETRY)
            if self.is_up:
                self.is_up = False
                self._reader.lose()
            self._look()

    def _read(self, line: socket.socket) -> None:
        line.settimeout(_LISTEN)
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.is_up = True
        while not self._over.is_set():
            with contextlib.suppress(TimeoutError):
                data = line.recv(_LARGEST)
                if not data:
                    return
                self._reader.take(data, self._now())
            self._look()

    def _look(self) -> None:
        self._reader.watch(self._now())
        with self.arrived:
            self.arrived.notify_all()


class Requests:
    """Lines to a program on the robot's controller, each of which it answers with one.

    Parameters
    ----------
    host : str
    port : int
    patience : float, s for an answer

    Raises
    ------
    LinkError : it cannot be connected to.
    """

    def __init__(self, host: str, port: int, patience: float) -> None:
        self._name = f"{host}:{port}"
        try:
            self._line = socket.create_connection((host, port), patience)
        except OSError as fault:
            raise LinkError(f"the robot's program on {self._name} cannot be connected to: {fault}") from fault

    def close(self) -> None:
        """End the connection."""
        self._line.close()

    def ask(self, line: str) -> str:
        """Send a line and return its answer; LinkError where there is none, or the connection has gone."""
        answer = b""
        try:
            self._line.sendall(line.encode("ascii") + b"\n")
            while not answer.endswith(b"\n"):
                data = self._line.recv(_LARGEST)
                if not data:
                    raise ConnectionResetError("it has hung up")
                answer += data
        except OSError as fault:
            raise LinkError(f"the robot's program on {self._name} does not answer {line!r}: {fault}") from fault
        return answer.decode("ascii", "replace").strip()
