"""python-can's bus over a serial adapter (slcan), reading all that has come at once instead of byte by byte."""

import time
from collections import deque
from typing import Any

from can import Message
from can.exceptions import error_check
from can.interfaces.slcan import slcanBus
from can.util import CAN_FD_DLC

_LONGEST_LINE = 1 + 8 + 1 + 2 * 64
_PATIENCE = 0.5
"""s for an adapter to take a command."""
_STANDARD, _EXTENDED = 3, 8
"""Digits of an identifier."""
_BITS = {_STANDARD: 11, _EXTENDED: 29}


class SlcanBus(slcanBus):
    """`can.Bus(interface="slcan")` that keeps up with a thousand CAN FD frames a second each way.

    python-can's own reads a byte a system call: of 1000 frames/s of 64 bytes it kept up with some 900
    (docs/validation/real-time.md).  It never recovers from a byte that is not ASCII, and waits for ever for an adapter
    that has stopped to read, and for an hour where the system's clock is set back by one.  Constructor and methods are
    the same.  Lines that are no frame are counted in `garbled`; answers of the adapter are read over.

    Parameters
    ----------
    options : any keywords of `can.interfaces.slcan.slcanBus`
    """

    def __init__(self, **options: Any) -> None:
        self.garbled = 0
        self._rest = b""
        self._frames: deque[Message] = deque()
        super().__init__(**options)

    def open(self) -> None:
        """Open the channel."""
        self.serialPortOrig.write_timeout = _PATIENCE
        super().open()

    def close(self) -> None:
        """Close the channel; the bit rates are set while it is closed, so this comes first."""
        self.serialPortOrig.write_timeout = _PATIENCE
        super().close()

    def recv(self, timeout: float | None = None) -> Message | None:
        """Return the next frame; None where none comes within `timeout` s."""
        until = None if timeout is None else time.monotonic() + timeout
        left = timeout
        while True:
            frame, _ = self._recv_internal(left)
            if frame is not None and self._matches_filters(frame):
                return frame
            if until is not None and (left := until - time.monotonic()) <= 0:
                return None

    def _recv_internal(self, timeout: float | None) -> tuple[Message | None, bool]:
        if not self._frames:
            port = self.serialPortOrig
            if timeout != 0.0:
                if port.timeout != timeout:
                    port.timeout = timeout
                self._take(port.read(max(1, port.in_waiting)))
            if waiting := port.in_waiting:
                self._take(port.read(waiting))
        return (self._frames.popleft() if self._frames else None), False

    def _write(self, string: str) -> None:
        """Hand a line over, without waiting until it has left: that would be a millisecond a frame over USB."""
        with error_check("Could not write to serial device"):
            self.serialPortOrig.write(string.encode() + self.LINE_TERMINATOR)

    def _take(self, data: bytes) -> None:
        *lines, self._rest = (self._rest + data).replace(b"\a", b"\r").split(b"\r")
        if len(self._rest) > _LONGEST_LINE:
            self._rest = self._rest[-_LONGEST_LINE:]
            self.garbled += 1
        now = time.time()
        for line in lines:
            kind = line[:1]
            if kind in b"tTdDbB" and kind:
                self._frame(kind, line, now)
            elif line not in b"zZ" and kind not in b"VNFrR":
                self.garbled += 1

    def _frame(self, kind: bytes, line: bytes, now: float) -> None:
        digits = _STANDARD if kind.islower() else _EXTENDED
        try:
            identifier = int(line[1 : 1 + digits], 16)
            data = bytes.fromhex(line[2 + digits :].decode("ascii"))
            complete = len(data) == CAN_FD_DLC[int(line[1 + digits : 2 + digits], 16)]
            complete &= 0 <= identifier < 1 << _BITS[digits]
        except (ValueError, IndexError):
            complete = False
        if not complete:
            self.garbled += 1
            return
        is_fd = kind in b"dDbB"
        message = Message(now, identifier, digits == _EXTENDED, is_fd=is_fd, bitrate_switch=kind in b"bB", data=data)
        self._frames.append(message)
