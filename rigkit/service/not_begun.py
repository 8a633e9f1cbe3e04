"""A procedure that is refused while it is made, before anything moves: no FAULT, the rig stays armed."""

from collections.abc import Iterator
from contextlib import contextmanager

from rigkit.service.rig import Desk

_OF_A_NAME = FileNotFoundError, PermissionError, IsADirectoryError, NotADirectoryError


class NotBegun(ValueError):
    """What a procedure was told, or the files that it names, do not do; the text says what, and what would."""


@contextmanager
def making(desk: Desk) -> Iterator[None]:
    """Turn what refuses a procedure in the block into `NotBegun`; what the system fails at stays what it is.

    In the block nothing moves, and nothing is kept of one that is refused; at its end the procedure has begun, which
    the `desk` is told.

    Raises
    ------
    NotBegun : a ValueError, a file that is not there or may not be read.
    OSError : any other, as it was.
    ValueError : one that such an OSError is the cause of, as it was.
    """
    try:
        yield
    except (ValueError, *_OF_A_NAME) as refused:
        if _has_failed(refused.__cause__ or refused.__context__):
            raise
        raise NotBegun(reason(refused)) from refused
    desk.begun()


def _has_failed(cause: BaseException | None) -> bool:
    """Tell whether the system has failed at a call: a disk, say; h5py's of a file's content have no number."""
    return isinstance(cause, OSError) and cause.errno is not None and not isinstance(cause, _OF_A_NAME)


def reason(fault: Exception) -> str:
    """Say what has gone wrong, in one line; the kind of what is a slip of ours as well."""
    match fault:
        case OSError(filename=str() | None as place, strerror=str() as text):
            return f"{place}: {text}" if place else text
        case ValueError() | OSError():
            return " ".join(str(fault).split())
    return " ".join(f"{type(fault).__name__}: {fault}".split())
