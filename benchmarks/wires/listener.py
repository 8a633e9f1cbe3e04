"""What goes over the robot's wire as the network sees it: moments by the kernel, however late anybody reads them."""

import ctypes
import socket
import struct
from contextlib import suppress
from threading import Event, Thread
from typing import Self

import numpy as np

REPORT, ANSWER, REFUSED = range(3)
"""A report of the robot, an answer to it, and a report that nobody listened to."""
_IP, _UDP, _ICMP = 0x0800, 17, 1
_STAMPS, _FILTER, _ROOM, _STATISTICS, _PACKETS = 35, 26, 33, 6, 263
_BUFFER = 1 << 24
_LOOK = 0.2
"""s from one look at whether it is to end to the next."""


class Listener:
    """Notes each datagram of a robot's port on this computer: a context manager; as root.

    Parameters
    ----------
    port : int, UDP, of the program that leads the robot

    Raises
    ------
    PermissionError : on entry, without the right to see what others send.
    """

    def __init__(self, port: int) -> None:
        self._port, self._over = port, Event()
        self._seen: list[tuple[float, int]] = []
        self._thread = Thread(target=self._run, name="listener", daemon=True)
        self.lost = 0

    def __enter__(self) -> Self:
        """Begin to listen."""
        self._socket = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(_IP))
        self._socket.bind(("lo", 0))
        self._socket.setsockopt(socket.SOL_SOCKET, _STAMPS, 1)
        self._socket.setsockopt(socket.SOL_SOCKET, _ROOM, _BUFFER)
        steps = ctypes.create_string_buffer(_chosen(self._port))
        program = struct.pack("HL", len(steps) // 8, ctypes.addressof(steps))
        self._socket.setsockopt(socket.SOL_SOCKET, _FILTER, program)
        self._socket.settimeout(_LOOK)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self._over.set()
        self._thread.join()
        self._socket.close()

    def taken(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return when reports, answers and refusals went over it since this was last asked, s of the system's clock."""
        seen, self._seen = self._seen, []
        _, lost = struct.unpack("II", self._socket.getsockopt(_PACKETS, _STATISTICS, 8))
        self.lost += lost
        times, kinds = np.array([each[0] for each in seen]), np.array([each[1] for each in seen], int)
        reports, answers, refused = (np.sort(times[kinds == kind]) for kind in (REPORT, ANSWER, REFUSED))
        return reports, answers, refused

    def _run(self) -> None:
        while not self._over.is_set():
            with suppress(TimeoutError):
                data, told, *_ = self._socket.recvmsg(128, 64)
                kind = kind_of(data, self._port)
                if kind is not None:
                    seconds, nanoseconds = struct.unpack("qq", told[0][2][:16])
                    self._seen.append((seconds + 1e-9 * nanoseconds, kind))


def kind_of(data: bytes, port: int) -> int | None:
    """Return what a packet is to the robot's wire, or None; from its IP header on."""
    header = 4 * (data[0] & 15)
    if data[9] == _ICMP:
        within = header + 8
        about = data[within + 4 * (data[within] & 15) :]
        return REFUSED if data[header] == 3 and int.from_bytes(about[2:4]) == port else None
    to = int.from_bytes(data[header + 2 : header + 4])
    return REPORT if to == port else ANSWER


def _chosen(port: int) -> bytes:
    """Return the kernel's filter: UDP of that port, and what was refused."""
    steps = (
        (0x30, 0, 0, 9),
        (0x15, 5, 0, _ICMP),
        (0x15, 0, 5, _UDP),
        (0x28, 0, 0, 20),
        (0x15, 2, 0, port),
        (0x28, 0, 0, 22),
        (0x15, 0, 1, port),
        (0x06, 0, 0, 0x40000),
        (0x06, 0, 0, 0),
    )
    return b"".join(struct.pack("HBBI", *each) for each in steps)
