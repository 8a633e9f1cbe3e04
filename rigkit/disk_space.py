"""Room on a disk: looked at before a run, and while one is recorded."""

import errno
import os
from pathlib import Path

from ctlblocks.room import DiskFault, free, megabytes

RESERVE = 64 * 2**20
"""Bytes that are left free: for the run's events, for what is computed from it, and for the rest of the computer."""


def require(path: Path, needed: int, what: str) -> None:
    """Refuse a run for which there is no room.

    Parameters
    ----------
    path : Path
        Where it is to be; need not exist.
    needed : int, bytes
    what : str
        It is, such as "30 shots".

    Raises
    ------
    DiskFault : fewer bytes are free than that and `RESERVE`.
    """
    there = free(path.absolute())
    if there < needed + RESERVE:
        text = (
            f"{what} may take {megabytes(needed)}, {megabytes(there)} are free and {megabytes(RESERVE)} of it stay so"
        )
        raise DiskFault(errno.ENOSPC, text, str(path))


def refuse_full(path: Path) -> None:
    """Raise a `DiskFault` where less than `RESERVE` is free in a folder."""
    if (there := free(path.absolute())) < RESERVE:
        text = f"{os.strerror(errno.ENOSPC)}: {megabytes(there)} are free, {megabytes(RESERVE)} of it stay so"
        raise DiskFault(errno.ENOSPC, text, str(path))
