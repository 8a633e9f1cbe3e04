"""A CAN FD adapter on a pseudo-terminal that speaks slcan, as CANable 2 and LAWICEL CANUSB do."""

import contextlib
import os
import select
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rigkit.posix import refuse_without, tty

LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)
"""Bytes of a frame by its length code, ISO 11898-1."""
BUFFER = 1 << 18
"""Bytes for the host that the adapter keeps while the host is slow; frames beyond are dropped, and counted."""

_CHUNK = 1 << 16
_LONGEST_LINE = 1 + 8 + 1 + 2 * 64
_SETTINGS = frozenset("SsYMmWAEZ")


@dataclass(frozen=True)
class Frame:
    """A data frame on the bus.

    Parameters
    ----------
    identifier : int
    data : bytes
    is_fd : bool
        With a faster data phase, as everything here that is FD.
    """

    identifier: int
    data: bytes
    is_fd: bool


class SlcanAdapter:
    """The adapter: the host opens `path`, what it sends is given by `received`, and `send` goes to it.

    It belongs to one thread: another one that wants it unplugged asks that one.  Writing never blocks.  A frame of 8
    bytes or fewer, sent as FD or not, keeps its form.  Not modelled: arbitration, the bus' own speed, error frames,
    time stamps, and what a real adapter answers to half of its commands.

    Parameters
    ----------
    path : Path or None
        A symbolic link to make to the pseudo-terminal, as udev's by-id: it stays the same when the adapter is unplugged
        and plugged in again.  Without one, `path` is the pseudo-terminal, another one each time.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.is_open = False
        self.dropped = self.refused = 0
        self._link = path
        self._ends: tuple[int, int] | None = None
        self._incoming, self._outgoing = bytearray(), bytearray()
        self.plug()

    @property
    def path(self) -> str:
        """What the host opens; OSError while it is unplugged."""
        return os.ttyname(self._fds[1]) if self._link is None else str(self._link)

    @property
    def is_plugged(self) -> bool:
        """Whether there is a device to open."""
        return self._ends is not None

    def plug(self) -> None:
        """Plug the adapter in; its channel is closed at first."""
        if self._ends is not None:
            return
        refuse_without(tty, "pseudo-terminals")
        host, device = os.openpty()
        for end in (host, device):
            tty.setraw(end)
        os.set_blocking(host, False)
        self._ends, self.is_open = (host, device), False
        if self._link is not None:
            new = self._link.with_name(f".{self._link.name}.new")
            new.unlink(missing_ok=True)
            new.symlink_to(os.ttyname(device))
            new.replace(self._link)

    def unplug(self) -> None:
        """Pull the adapter out: the host's port hangs up, and is gone."""
        if self._ends is None:
            return
        if self._link is not None:
            self._link.unlink(missing_ok=True)
        for end in self._ends:
            os.close(end)
        self._ends, self.is_open = None, False
        self._incoming.clear()
        self._outgoing.clear()

    def wait(self, seconds: float) -> None:
        """Return when the host has sent something, when there is room for what it is to get, or after `seconds`."""
        host = [self._ends[0]] if self._ends else []
        select.select(host, host if self._outgoing else [], [], max(seconds, 0.0))

    def received(self) -> Iterator[Frame]:
        """Give the frames that the host has sent; commands are answered, lines that are neither refused and counted."""
        if self._ends is None:
            return
        with contextlib.suppress(BlockingIOError):
            self._incoming += os.read(self._ends[0], _CHUNK)
        *lines, rest = bytes(self._incoming).split(b"\r")
        self._incoming[:] = rest[-_LONGEST_LINE:]
        for line in lines:
            frame = self._obeyed(line.decode("latin-1"))
            if frame is not None:
                yield frame
        self._flush()

    def send(self, frame: Frame) -> None:
        """Give a frame to the host, if its channel is open and there is room."""
        if not self.is_open:
            return
        code = LENGTHS.index(len(frame.data))
        line = f"{'b' if frame.is_fd else 't'}{frame.identifier:03X}{code:X}{frame.data.hex().upper()}\r"
        if len(self._outgoing) + len(line) > BUFFER:
            self.dropped += 1
        else:
            self._outgoing += line.encode()
        self._flush()

    def spill(self, noise: bytes) -> None:
        """Give the host bytes that are no frame, as a bad cable does."""
        self._outgoing += noise
        self._flush()

    @property
    def _fds(self) -> tuple[int, int]:
        if self._ends is None:
            raise FileNotFoundError("the adapter is unplugged")
        return self._ends

    def _obeyed(self, line: str) -> Frame | None:
        """Carry a command out and answer it; return the frame that it sends, if it does."""
        if line[:1] in ("t", "T", "d", "D", "b", "B"):
            return self._sent(line)
        answer = "\r"
        if line in ("O", "L", "C"):
            self.is_open = line != "C"
        elif line in ("V", "N", "F"):
            answer = {"V": "V1013\r", "N": "N0001\r", "F": "F00\r"}[line]
        elif line[:1] not in _SETTINGS and line:
            self.refused += 1
            answer = "\a"
        self._outgoing += answer.encode()
        return None

    def _sent(self, line: str) -> Frame | None:
        start = 4 if line[0].islower() else 9
        try:
            identifier, length = int(line[1:start], 16), LENGTHS[int(line[start], 16)]
            data = bytes.fromhex(line[start + 1 :])
        except (ValueError, IndexError):
            identifier, length, data = 0, -1, b""
        if not self.is_open or len(data) != length:
            self.refused += 1
            self._outgoing += b"\a"
            return None
        self._outgoing += b"z\r" if line[0].islower() else b"Z\r"
        return Frame(identifier, data, line[0] in "dDbB")

    def _flush(self) -> None:
        if self._ends is None:
            return
        with contextlib.suppress(BlockingIOError):
            while self._outgoing:
                del self._outgoing[: os.write(self._ends[0], self._outgoing)]
