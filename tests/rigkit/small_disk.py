"""Disks that are full or read-only: real ones of memory where this process may mount them, else a limit of the system.

A limit (RLIMIT_FSIZE) needs no rights, and its error is another: EFBIG, File too large.
"""

import errno
import os
import resource
import subprocess
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

SIZE = 256 * 1024
"""Bytes."""

Disk = Callable[[Path], AbstractContextManager[tuple[Path, str]]]
"""Gives a folder on it, and what the system says of it."""


@contextmanager
def full(folder: Path, size: int = SIZE) -> Iterator[tuple[Path, str]]:
    """Mount a disk of that many bytes."""
    with _mounted(folder, f"size={size}") as place:
        yield place, os.strerror(errno.ENOSPC)


@contextmanager
def read_only(folder: Path) -> Iterator[tuple[Path, str]]:
    """Mount a disk that cannot be written to."""
    with _mounted(folder, "ro") as place:
        yield place, os.strerror(errno.EROFS)


@contextmanager
def limited(folder: Path) -> Iterator[tuple[Path, str]]:
    """Allow no file to pass `SIZE` bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (SIZE, hard))
    try:
        yield folder, os.strerror(errno.EFBIG)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@contextmanager
def _mounted(folder: Path, option: str) -> Iterator[Path]:
    place = folder / "disk"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", option, "tmpfs", str(place)]
    try:
        subprocess.run(command, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("this process may not mount a disk: it is not root, or in a container")
    try:
        yield place
    finally:
        subprocess.run(["umount", "--lazy", str(place)], check=True)
