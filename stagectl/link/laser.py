"""The laser sensor behind its serial line: a thread that reads it, and a Block that holds its newest value."""

import errno
import time
from collections.abc import Callable
from threading import Event, Thread
from typing import Any, Self

import numpy as np

from ctlblocks.block import Block, Port
from rigkit.named_code import named_class
from stagectl.link.bus import LinkError
from stagectl.link.config import Laser
from stagectl.link.laser_protocol import LaserError, Lines, reading, request

_LISTEN = 0.02
"""s without a byte after which the thread looks up, and after which an answer is given up."""
_RETRY = 0.2
"""s between attempts to open a port that has gone."""


class LaserLine:
    """The sensor on its port: a context manager that reads it all the time.

    It needs no acknowledgement: a value that is out of range or too old is NaN, which whoever uses it must refuse.

    Parameters
    ----------
    laser : Laser
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    LinkError : on entry, when the port cannot be opened, or another program has it.
    """

    def __init__(self, laser: Laser, now: Callable[[], float] = time.monotonic) -> None:
        self.laser = laser
        self.readings = self.garbled = 0
        self.complaint = ""
        self._now, self._lines = now, Lines()
        self._newest, self._heard = np.nan, -np.inf
        self._port: Any = None
        self._over, self._changed = Event(), Event()
        self._thread = Thread(target=self._read, name="laser", daemon=True)

    def __enter__(self) -> Self:
        """Open the port and begin to read."""
        self._port = self._opened()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self._over.set()
        self._thread.join()
        self._close()

    @property
    def displacement(self) -> float:
        """The newest value, m; NaN where it is out of range, or older than `laser.silence`."""
        return self._newest if self._now() - self._heard <= self.laser.silence else np.nan

    def wait(self, readings: int, seconds: float) -> bool:
        """Return whether so many values have come in all, as soon as they have or after `seconds`."""
        deadline = time.monotonic() + seconds
        while self.readings < readings and (left := deadline - time.monotonic()) > 0:
            self._changed.wait(left)
            self._changed.clear()
        return self.readings >= readings

    def take(self, data: bytes) -> None:
        """Read what has come from the port."""
        for line in self._lines.take(data):
            try:
                found = reading(line)
            except LaserError as fault:
                self.complaint = str(fault)
                self.garbled += 1
                continue
            if found.output == self.laser.output:
                self._newest, self._heard = found.displayed * self.laser.scale, self._now()
                self.readings += 1
                self._changed.set()

    def _read(self) -> None:
        while not self._over.is_set():
            if self._port is None:
                self._reopen()
                continue
            try:
                self._exchange()
            except (OSError, TypeError) as fault:  # TypeError: pyserial, of a port that has gone
                self.complaint = f"the laser's port {self.laser.device} has gone: {fault}"
                self._close()

    def _exchange(self) -> None:
        """Ask, where the sensor wants to be asked, and read what comes till it is answered or falls silent."""
        port, lines = self._port, self._lines
        if self.laser.mode == "request":
            port.write(request(self.laser.output))
        before = lines.complete
        while data := port.read(max(port.in_waiting, 1)):
            self.take(data)
            if self.laser.mode == "continuous" or lines.complete > before:
                break

    def _opened(self) -> Any:
        try:
            build = named_class(self.laser.port, "the class of a pyserial port", _is_port)
        except ValueError as fault:
            raise ValueError(f"laser.port, {fault}") from fault
        try:
            return build(self.laser.device, self.laser.baud, timeout=_LISTEN, write_timeout=_RETRY, exclusive=True)
        except (OSError, ValueError) as fault:
            if getattr(fault, "errno", None) == errno.EAGAIN:
                raise LinkError(f"laser.device {self.laser.device!r} is in use by another program") from fault
            raise LinkError(f"{self.laser.port} cannot open laser.device {self.laser.device!r}: {fault}") from fault

    def _reopen(self) -> None:
        try:
            self._port = self._opened()
        except LinkError:
            self._over.wait(_RETRY)
        else:
            self._lines.forget()

    def _close(self) -> None:
        port, self._port = self._port, None
        if port is not None:
            port.close()


def _is_port(found: type) -> bool:
    return all(hasattr(found, each) for each in ("in_waiting", "read", "write", "close"))


class Displacement(Block):
    """Hold the laser's newest value: `displacement` (m) out, NaN where it is out of range or too old.

    Parameters
    ----------
    line : LaserLine
    """

    outputs = (Port("displacement", "m"),)

    def __init__(self, line: LaserLine) -> None:
        self.line = line

    def process(self, displacement: np.ndarray) -> None:
        """Fill one frame."""
        displacement.fill(self.line.displacement)
