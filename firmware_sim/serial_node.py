"""The laser sensor's controller on a pseudo-terminal: answers requests, or sends by itself, and can be made to fail."""

import contextlib
import os
import select
import time
from collections.abc import Callable
from pathlib import Path
from threading import Event
from typing import Literal

from rigkit.posix import refuse_without, tty
from stagectl.link.laser_protocol import END, LONGEST_LINE, said

_WAIT = 0.01
_OUTPUTS = (b"M1", b"M2")


class SerialNode:
    """A controller of Keyence's LK-G kind with one head on OUT1; OUT2 has no value.

    Not modelled: the line's own speed, and every command but the request for a value.

    Parameters
    ----------
    path : Path
        A symbolic link to make to the pseudo-terminal.
    displacement : callable() -> float, m; NaN where there is no target
    mode : "continuous" or "request"
    rate : float, values/s it sends by itself
    unit : float, m that one on its display is worth
    now : callable() -> float, s, a monotonic clock
    """

    def __init__(
        self,
        path: Path,
        displacement: Callable[[], float],
        mode: Literal["continuous", "request"] = "continuous",
        rate: float = 250.0,
        unit: float = 1e-3,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.is_silent = False
        self._path, self._displacement, self._mode = path, displacement, mode
        self._period, self._unit, self._now = 1.0 / rate, unit, now
        refuse_without(tty, "pseudo-terminals")
        self._host, self._device = os.openpty()
        for end in (self._host, self._device):
            tty.setraw(end)
        os.set_blocking(self._host, False)
        self._incoming, self._outgoing = b"", b""
        self._due = now()
        new = path.with_name(f".{path.name}.new")
        new.unlink(missing_ok=True)
        new.symlink_to(os.ttyname(self._device))
        new.replace(path)

    def run(self, stop: Event) -> None:
        """Serve until `stop` is set; then hang up."""
        try:
            while not stop.is_set():
                wait = min(self._due - self._now(), _WAIT) if self._mode == "continuous" else _WAIT
                select.select([self._host], [], [], max(wait, 0.0))
                self.serve()
        finally:
            self._path.unlink(missing_ok=True)
            for end in (self._host, self._device):
                os.close(end)

    def serve(self) -> None:
        """Answer what was asked, and send what is due."""
        with contextlib.suppress(BlockingIOError):
            self._incoming += os.read(self._host, 4096)
        *lines, rest = self._incoming.split(END)
        self._incoming = rest[-LONGEST_LINE:]
        if not self.is_silent:
            for line in lines:
                self._outgoing += self._answer(line.strip().upper())
        if self._mode == "continuous" and self._now() >= self._due:
            self._due = max(self._due + self._period, self._now())
            if not self.is_silent:
                self._outgoing += b"TG,1," + said(self._displacement() / self._unit) + END
        self.spill(b"")

    def spill(self, noise: bytes) -> None:
        """Send bytes as they are; what the host does not read in time is dropped, as a serial line does."""
        data, self._outgoing = self._outgoing + noise, b""
        with contextlib.suppress(BlockingIOError):
            if data:
                os.write(self._host, data)

    def _answer(self, line: bytes) -> bytes:
        if line not in _OUTPUTS:
            return b"ER,%s,00%s" % (line[:LONGEST_LINE], END)
        value = said(self._displacement() / self._unit) if line == b"M1" else b"XXXXXXXX"
        return line + b"," + value + END
