"""Modules of the standard library that POSIX systems alone have: None elsewhere, where whoever needs one says so."""

from importlib import import_module
from typing import Any


def _present(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        return None


fcntl, resource, termios, tty = map(_present, ("fcntl", "resource", "termios", "tty"))


def refuse_without(module: Any, what: str) -> None:
    """Refuse what needs a module that is absent.

    Parameters
    ----------
    module : module or None
    what : str
        What cannot be, such as "a pseudo-terminal".

    Raises
    ------
    OSError : it is absent.
    """
    if module is None:
        raise OSError(f"this system has no {what}: that needs Linux, or another POSIX system")
