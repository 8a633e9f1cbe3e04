"""A procedure that is refused while it is made, before anything moves: no FAULT, the rig stays armed."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager

from rigkit import os_fault
from rigkit.service.rig import Desk

_OF_A_NAME = FileNotFoundError, PermissionError, IsADirectoryError, NotADirectoryError
_NO_ROOM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS})


class NotBegun(ValueError):
    """What a procedure was told, or the files that it names, do not do; the text says what, and what would."""


@contextmanager
def making(desk: Desk) -> Iterator[None]:
    """Turn what refuses a procedure in the block into `NotBegun`; what the system fails at stays what it is.

    In the block nothing moves, and nothing is kept of one that is refused; at its end the procedure has begun, which
    the `desk` is told.

    Raises
    ------
    NotBegun : a ValueError, a file that is not there or may not be read, a disk that has no room.
    OSError : any other, as it was.
    ValueError : one that such an OSError is the cause of, as it was.
    """
    try:
        yield
    except (ValueError, OSError) as refused:
        cause = refused if isinstance(refused, OSError) else refused.__cause__ or refused.__context__
        is_refusal = isinstance(cause, _OF_A_NAME) or getattr(cause, "errno", None) in _NO_ROOM
        if isinstance(refused, OSError) and not is_refusal:
            raise
        if _has_failed(cause) and not is_refusal:
            raise
        raise NotBegun(reason(refused)) from refused
    desk.begun()


def _has_failed(cause: BaseException | None) -> bool:
    """Tell whether the system has failed at a call: a disk, say; h5py's of a file's content have no number."""
    return isinstance(cause, OSError) and cause.errno is not None


def reason(fault: Exception) -> str:
    """Say what has gone wrong, in one line; the kind of what is a slip of ours as well."""
    match fault:
        case OSError(strerror=str()):
            return os_fault.told(fault)
        case ValueError() | OSError():
            return " ".join(str(fault).split())
    return " ".join(f"{type(fault).__name__}: {fault}".split())
