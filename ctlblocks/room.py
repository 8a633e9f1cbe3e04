"""Room on a disk: how much a recording takes, how much is free, and both where a disk has refused a file."""

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

WIDEST_NUMBER = {"float32": 15, "float64": 24}
"""Characters of a number in a CSV file with its comma, at most."""
OF_A_DISK = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO})
"""What the system says of a disk that is full or fails, in place of what was asked for wrongly."""
_BLOCK = 2**16
"""Bytes that a disk which is full does not take any more."""


class DiskFault(OSError):
    """A disk that is full or fails: `filename` is the file, `strerror` says why, what is free where, and wanted."""


@contextmanager
def writing(path: Path, wanted: int | None, through: Path | None = None) -> Iterator[None]:
    """Turn what a disk fails at in the block into a `DiskFault`; any other error stays what it is.

    Parameters
    ----------
    path : Path
        File that is written.
    wanted : int, bytes, or None where nobody knows
    through : Path, optional
        The file that it is until it is whole.
    """
    try:
        yield
    except DiskFault:
        raise
    except OSError as fault:
        number = fault.errno or (0 if through is None else _refusal(through))
        own = {str(path), str(through), "None"}
        if number not in OF_A_DISK or not own & {str(fault.filename), str(fault.filename2)}:
            raise
        raise DiskFault(number, _standing(number, path, wanted), str(path)) from fault


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


def megabytes(count: float) -> str:
    """Say a number of bytes.

    Examples
    --------
    >>> megabytes(3_400_000_000)
    '3400 MB'
    """
    return f"{count / 1e6:.4g} MB" if count < 1e9 else f"{count / 1e6:.0f} MB"


def _standing(number: int, path: Path, wanted: int | None) -> str:
    """Say what the fault is, what is free in the folder of a file, and what is wanted."""
    text = os.strerror(number)
    with suppress(OSError):  # of a disk that is gone
        text += f": {megabytes(free(path.absolute().parent))} are free in {path.parent}/"
        text += ", more is wanted" if wanted is None else f", {megabytes(wanted)} are wanted"
    return text


def _refusal(path: Path) -> int:
    """Ask the system once more why a library has failed that does not say: 0 where it takes another block."""
    try:
        with path.open("ab", buffering=0) as file:
            if file.write(bytes(_BLOCK)) != _BLOCK:
                file.write(bytes(_BLOCK))
            os.fsync(file.fileno())
    except OSError as fault:
        return fault.errno or 0
    return 0
