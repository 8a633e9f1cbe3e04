"""Room on a disk: looked at before a run, and while one is recorded."""

import errno
import os
import shutil
from pathlib import Path

RESERVE = 64 * 2**20
"""Bytes that are left free: for the run's events, for what is computed from it, and for the rest of the computer."""
WIDEST_NUMBER = {"float32": 15, "float64": 24}
"""Characters of a number in a CSV file with its comma, at most."""


def bytes_of(samples: int, channels: int, dtype: str, suffix: str) -> int:
    """Return how much room a recording may take, with a header.

    Parameters
    ----------
    samples, channels : int
    dtype : "float32" or "float64"
    suffix : "wav" or "csv"

    Examples
    --------
    >>> bytes_of(1000, 2, "float64", "wav")
    18000
    """
    number = WIDEST_NUMBER[dtype] if suffix == "csv" else {"float32": 4, "float64": 8}[dtype]
    return samples * channels * number + 2_000


def free(path: Path) -> int:
    """Return the bytes that are free where `path` is, or would be made."""
    while not path.exists():
        path = path.parent
    return shutil.disk_usage(path).free


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
    OSError : fewer bytes are free than that and `RESERVE`.
    """
    there = free(path.absolute())
    if there < needed + RESERVE:
        text = (
            f"{what} may take {megabytes(needed)}, {megabytes(there)} are free and {megabytes(RESERVE)} of it stay so"
        )
        raise OSError(errno.ENOSPC, text, str(path))


def refuse_full(path: Path) -> None:
    """Raise OSError where less than `RESERVE` is free."""
    stand = os.statvfs(path)
    if stand.f_bavail * stand.f_frsize < RESERVE:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def megabytes(count: float) -> str:
    """Say a number of bytes.

    Examples
    --------
    >>> megabytes(3_400_000_000)
    '3400 MB'
    """
    return f"{count / 1e6:.4g} MB" if count < 1e9 else f"{count / 1e6:.0f} MB"
