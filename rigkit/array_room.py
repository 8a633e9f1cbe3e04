"""How much memory and time the process may take that reads a file of arrays, which may be damaged."""

import resource
from pathlib import Path

ROOM = 2**29
"""Bytes that a library may take beside what it has read."""
PATIENCE = 60
"""s of the processor's time for what comes next to be read: on some damaged files the library goes round for ever."""


def let_have(room: int) -> None:
    """Let this process have `room` bytes more than it has now, and `PATIENCE` more of the processor's time."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    used = resource.getrusage(resource.RUSAGE_SELF)
    for limit, wanted in (
        (resource.RLIMIT_AS, pages * resource.getpagesize() + room),
        (resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime) + PATIENCE),
    ):
        hard = resource.getrlimit(limit)[1]
        resource.setrlimit(limit, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
