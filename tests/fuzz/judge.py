"""What a reader may do with a damaged file: refuse it with our own error, or read what it says."""

from collections.abc import Callable
from typing import TypeVar

Read = TypeVar("Read")


class Finding(AssertionError):
    """A reader that did something else."""


def is_accepted(
    read: Callable[[], Read], check: Callable[[Read], None], own: type[Exception] | tuple[type[Exception], ...]
) -> bool:
    """Return whether it reads; raise `Finding` where it fails otherwise than by `own`, or reads what is not there.

    Parameters
    ----------
    read : callable() -> anything
    check : callable(anything)
        Raises AssertionError where that is not what the file says.
    own : exception class, or several
        The errors that tell a person what is wrong with a file.
    """
    try:
        found = read()
    except own as fault:
        if not str(fault).strip():
            raise Finding(f"a {type(fault).__name__} without a word") from None
        return False
    except Exception as fault:
        raise Finding(f"{type(fault).__name__}: {fault}") from fault
    try:
        check(found)
    except AssertionError as fault:
        raise Finding(f"read in silence: {fault}") from fault
    return True
