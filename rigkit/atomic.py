"""Files and folders that are there whole or not at all: a file is written under another name beside its place first."""

import errno
import os
import re
import secrets
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ctlblocks.room import writing

_TEMPORARY = re.compile(r"\..+\.[0-9a-f]{8}\.tmp(\.\w+)?")


@contextmanager
def replacing(path: str | Path, wanted: int | None = None) -> Iterator[Path]:
    """Give a temporary name with the same suffix; when the block ends, what stands there takes the place of `path`.

    The bytes are on the disk before the name changes, and the name before this returns.  A block that raises leaves
    `path` as it was.  A process killed in the block leaves the temporary file, which `leftovers` finds.

    Parameters
    ----------
    path : path
    wanted : int, bytes, optional
        Said where a disk is full.

    Raises
    ------
    DiskFault : the disk is full, or fails.
    IsADirectoryError : a folder is there.
    """
    path = Path(path)
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder, must be a file", str(path))
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "there is no such folder", str(path.parent))
    beside = temporary(path)
    try:
        with writing(path, wanted, beside):
            yield beside
            to_disk(beside)
            os.replace(beside, path)
            to_disk(path.parent)
    finally:
        with suppress(OSError):  # of a disk that takes no change at all
            beside.unlink(missing_ok=True)


def temporary(path: Path) -> Path:
    """Return a new name beside `path`, with the same suffix, that `is_leftover` knows."""
    return path.with_name(f".{path.stem}.{secrets.token_hex(4)}.tmp{path.suffix}")


def write(path: str | Path, content: str | bytes) -> None:
    """Write a whole file, text as UTF-8, in one step."""
    whole = content.encode() if isinstance(content, str) else content
    with replacing(path, len(whole)) as temporary:
        temporary.write_bytes(whole)


@contextmanager
def folder(path: Path) -> Iterator[Path]:
    """Make a folder, and those above it, to be filled; where the block raises, those that stay empty go again."""
    made = absent(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        yield path
    except BaseException:
        remove_empty(made)
        raise


def absent(path: Path) -> list[Path]:
    """Return a folder and those above it that are not there, the deepest first."""
    return [each for each in (path, *path.parents) if not each.exists()]


def remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders, the deepest first; one that has something in it stays."""
    for each in folders:
        with suppress(OSError):
            each.rmdir()


def leftovers(folder: Path) -> Iterator[Path]:
    """Find the temporary files that killed writes left in `folder` and below."""
    return (path for path in folder.rglob(".*.tmp*") if is_leftover(path))


def is_leftover(path: Path) -> bool:
    """Whether a file has the name of one that was being written."""
    return _TEMPORARY.fullmatch(path.name) is not None


def to_disk(path: Path) -> None:
    """Wait until the content of a file, or the names in a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
