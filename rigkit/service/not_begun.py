"""A procedure that is refused while it is made, before anything moves: no FAULT, the rig stays armed."""

from collections.abc import Iterator
from contextlib import contextmanager


class NotBegun(ValueError):
    """What a procedure was told, or the files that it names, do not do; the text says what, and what would."""


@contextmanager
def making() -> Iterator[None]:
    """Turn what refuses a procedure in the block into `NotBegun`; what the system fails at stays what it is.

    In the block nothing moves, and nothing is kept of one that is refused.

    Raises
    ------
    NotBegun : a ValueError, a file that is not there or may not be read.
    OSError : any other, as it was.
    """
    try:
        yield
    except (ValueError, FileNotFoundError, PermissionError) as refused:
        raise NotBegun(reason(refused)) from refused


def reason(fault: Exception) -> str:
    """Say what has gone wrong, in one line; the kind of what is a slip of ours as well."""
    match fault:
        case OSError(filename=str() | None as place, strerror=str() as text):
            return f"{place}: {text}" if place else text
        case ValueError() | OSError():
            return " ".join(str(fault).split())
    return " ".join(f"{type(fault).__name__}: {fault}".split())
