"""A TCP server that never waits: lines come in, bytes go out to all who are connected."""

import contextlib
import socket

_LARGEST = 65_536
_LONGEST_LINE = 4_096


class TcpServer:
    """Listens on loopback, or where it is told to.

    Parameters
    ----------
    host : str
    port : int, 0 for any that is free
    """

    def __init__(self, host: str, port: int) -> None:
        self._listener = socket.create_server((host, port))
        self._listener.setblocking(False)
        self.address: tuple[str, int] = self._listener.getsockname()
        self._lines: dict[socket.socket, bytes] = {}

    def received(self) -> list[tuple[socket.socket, str]]:
        """Take in who connects and what has come; return complete lines and who sent them."""
        with contextlib.suppress(BlockingIOError):
            while True:
                line, _ = self._listener.accept()
                line.setblocking(False)
                line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._lines[line] = b""
        return [(line, text) for line in list(self._lines) for text in self._read(line)]

    def send(self, data: bytes, to: socket.socket | None = None) -> None:
        """Send to all, or to one; who does not read in time is hung up on."""
        for line in [to] if to is not None else list(self._lines):
            try:
                whole = line.send(data) == len(data)
            except OSError:
                whole = False
            if not whole:
                self._drop(line)

    def hang_up(self) -> None:
        """Drop every connection."""
        for line in list(self._lines):
            self._drop(line)

    def close(self) -> None:
        """Hang up and listen no more."""
        self.hang_up()
        self._listener.close()

    def _read(self, line: socket.socket) -> list[str]:
        try:
            data = line.recv(_LARGEST)
        except BlockingIOError:
            return []
        except OSError:
            data = b""
        if not data:
            self._drop(line)
            return []
        *lines, rest = (self._lines[line] + data).split(b"\n")
        self._lines[line] = rest[-_LONGEST_LINE:]
        return [each.decode("ascii", "replace").strip() for each in lines]

    def _drop(self, line: socket.socket) -> None:
        self._lines.pop(line, None)
        line.close()
