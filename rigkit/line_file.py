"""Files that grow by a line: each line is there whole or not at all."""

import csv
import io
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from ctlblocks.room import writing
from rigkit.atomic import to_disk
from rigkit.text_file import decoded


def append(path: Path, line: str) -> None:
    """Add a line and wait until it is on the disk.

    Raises
    ------
    ValueError : `line` holds a line break.
    OSError : the disk is full, or fails; the file is as it was.
    """
    if "\n" in line or "\r" in line:
        raise ValueError(f"{path}: {line!r} is more than one line")
    content, made = f"{line}\n".encode(), not path.exists()
    with writing(path, len(content)):
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    try:
        size, done = os.fstat(handle).st_size, 0
        try:
            with writing(path, len(content)):
                while done < len(content):  # a disk that is nearly full takes a part, and then says so
                    done += os.write(handle, content[done:])
                os.fsync(handle)
        except OSError:
            with suppress(OSError):
                os.ftruncate(handle, size)
            raise
    finally:
        os.close(handle)
    if made:
        to_disk(path.parent)


def lines(path: Path) -> list[str]:
    """Read the whole lines; none where there is no file.  A last line that a kill cut short is left out.

    Raises
    ------
    TextFault : a line is not UTF-8.
    """
    content = path.read_bytes() if path.exists() else b""
    whole = content[: content.rfind(b"\n") + 1]
    return [decoded(line, path, number) for number, line in enumerate(whole.split(b"\n")[:-1], start=1)]


def first(path: Path) -> str:
    """Read the first line; empty where there is none yet, or no file."""
    if not path.exists():
        return ""
    with path.open("rb") as file:
        line = file.readline()
    return decoded(line[:-1], path) if line.endswith(b"\n") else ""


def repair(path: Path) -> None:
    """Cut off a last line that a kill cut short, so that the next begins on its own."""
    if not path.exists():
        return
    with path.open("rb+") as file:
        whole = file.read().rfind(b"\n") + 1
        file.truncate(whole)
        os.fsync(file.fileno())


def as_csv(cells: Iterable[object]) -> str:
    """Return cells as a line of CSV, without its end.

    Examples
    --------
    >>> as_csv(["a, b", 1])
    '"a, b",1'
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow(cells)
    return text.getvalue()
