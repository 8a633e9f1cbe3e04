"""How much memory and time the process may take that reads a file of arrays, which may be damaged."""

import signal
from pathlib import Path

from rigkit.posix import resource

ROOM = 2**29
"""Bytes that a library may take beside what it has read."""
PATIENCE = 0.8
"""s of the processor's time for what a library does at once: on some damaged files it goes round for ever."""
SLOWEST = 2e7
"""Bytes per s beside that."""


def let_have(size: int, room: int = ROOM) -> None:
    """Let this process have so much more than it has now, before it reads what follows; no limit where there is none.

    Parameters
    ----------
    size : int, bytes
        What it reads.
    room : int, bytes
        What it may take beside.
    """
    if resource is None:
        return
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    wanted, hard = pages * resource.getpagesize() + room + size, resource.getrlimit(resource.RLIMIT_AS)[1]
    resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
    signal.setitimer(signal.ITIMER_PROF, PATIENCE + size / SLOWEST)  # kills: a library would hear nothing else
