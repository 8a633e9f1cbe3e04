"""Text files that a person or another program may have written: UTF-8, with or without its mark."""

import os
from pathlib import Path


class TextFault(ValueError):
    """A file that holds no text, or too much; the message names the file, and the line where it is one."""


def read_text(path: str | os.PathLike[str], largest: int | None = None) -> str:
    """Read a whole file of text, its ends of lines as they are.

    Parameters
    ----------
    path : path
    largest : int, bytes, or None for any

    Raises
    ------
    TextFault : it has more bytes, or some that are not UTF-8.
    OSError : it cannot be read.
    """
    with Path(path).open("rb") as file:
        content = file.read(-1 if largest is None else largest + 1)
    if largest is not None and len(content) > largest:
        raise TextFault(f"{path}: more than {largest} bytes")
    return decoded(content, path).removeprefix("\ufeff")


def decoded(content: bytes, path: str | os.PathLike[str], first: int = 1) -> str:
    """Return bytes of a file as text; TextFault where some are not UTF-8.  Its first line is number `first`."""
    try:
        return content.decode()
    except UnicodeDecodeError as fault:
        line = content.count(b"\n", 0, fault.start) + first
        raise TextFault(f"{path}: byte {content[fault.start]:#04x} in line {line} is not UTF-8") from None
