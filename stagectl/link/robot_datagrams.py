"""Carries datagrams between the robot's controller and what is said about them: one thread owns the socket."""

import contextlib
import select
import socket
from collections import deque
from collections.abc import Callable
from threading import Condition, Event, Thread
from typing import Protocol

from rigkit.priority import real_time
from stagectl.link.bus import LinkError

_LARGEST = 65_536
_LONGEST_END = 2.0
"""s for the thread to end."""


def resolved(host: str, port: int, name: str) -> tuple[str, int]:
    """Return the address and port that datagrams of a host come from; LinkError where `name`.host is not known."""
    try:
        address, found = socket.getaddrinfo(host, port, socket.AF_INET, socket.SOCK_DGRAM)[0][4][:2]
    except OSError as fault:
        raise LinkError(f"{name}.host {host} is not known: {fault}") from fault
    return str(address), int(found)


class Talk(Protocol):
    """What takes datagrams and gives the answers; called by the carrier's thread alone."""

    peer: tuple[str, int] | None

    def take(self, data: bytes, sender: tuple[str, int], now: float) -> None:
        """Take a datagram."""

    def give(self) -> bytes | None:
        """Return what is to be sent now."""

    def watch(self, now: float) -> None:
        """Look at the time; all that has come is taken."""


class Datagrams:
    """Owns a UDP socket.

    Parameters
    ----------
    listen : str, this computer's address
    port : int, 0 for any that is free
    talk : Talk
    now : callable() -> float, s, a monotonic clock
    patience : float, s without a datagram after which the thread looks at the time
    name : str, of the table in the cell's file
    """

    def __init__(
        self, listen: str, port: int, talk: Talk, now: Callable[[], float], patience: float, name: str = "robot"
    ) -> None:
        self.arrived = Condition()
        self._talk, self._now, self._patience = talk, now, patience
        self._address, self._name = (listen, port), name
        self._over = Event()
        self._asked: deque[tuple[Callable[[], None], Event]] = deque()
        self._thread = Thread(target=self._run, name=name, daemon=True)

    @property
    def address(self) -> tuple[str, int]:
        """Address and port that are listened to."""
        return self._address

    def open(self) -> None:
        """Begin to listen; LinkError where the address or the port cannot be had."""
        listen, port = self._address
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind(self._address)
        except OSError as fault:
            self._socket.close()
            raise LinkError(
                f"{self._name}.listen {listen}, {self._name}.port {port} cannot be listened to: {fault}"
            ) from fault
        self._address = self._socket.getsockname()
        self._bell, self._rope = socket.socketpair()
        for each in (self._socket, self._bell, self._rope):
            each.setblocking(False)
        self._thread.start()

    def close(self) -> None:
        """End the thread and close the socket."""
        if self._thread.is_alive():
            self._over.set()
            self.flush()
            self._thread.join(_LONGEST_END)
            for each in (self._socket, self._bell, self._rope):
                each.close()

    def flush(self) -> None:
        """Have what waits sent now."""
        with contextlib.suppress(BlockingIOError):  # it rings already
            self._rope.send(b"\0")

    def ask(self, call: Callable[[], None]) -> None:
        """Have `call` made by the thread, between datagrams; return once it is made."""
        if not self._thread.is_alive():
            call()
            return
        done = Event()
        self._asked.append((call, done))
        self.flush()
        done.wait(_LONGEST_END)

    def _run(self) -> None:
        with real_time():
            while not self._over.is_set():
                self._turn()

    def _turn(self) -> None:
        select.select([self._socket, self._bell], [], [], self._patience)
        with contextlib.suppress(BlockingIOError):
            self._bell.recv(_LARGEST)
        while self._asked:
            call, done = self._asked.popleft()
            call()
            done.set()
        before = self._now()  # what came until now has been read when we look at the time
        with contextlib.suppress(BlockingIOError, ConnectionError):  # refused: the robot's end has gone
            while True:
                data, sender = self._socket.recvfrom(_LARGEST)
                self._talk.take(data, sender, self._now())
                self._answer()
        self._talk.watch(before)
        self._answer()
        with self.arrived:
            self.arrived.notify_all()

    def _answer(self) -> None:
        answer, peer = self._talk.give(), self._talk.peer
        if answer is not None and peer is not None:
            with contextlib.suppress(OSError):  # its silence is what counts
                self._socket.sendto(answer, peer)
