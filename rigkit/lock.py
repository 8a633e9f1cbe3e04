"""The lock on a folder: held by one process at a time, gone with it however it ends."""

import os
from pathlib import Path

from ctlblocks.room import writing
from rigkit.posix import fcntl


class FolderInUseError(ValueError):
    """A folder that another process is working in, or that holds something already."""


class Lock:
    """Hold the file `path` locked until `release`.  The file stays; only the lock on it counts.

    A system without such locks (no `fcntl`) keeps nobody out.

    Parameters
    ----------
    path : Path
        A file in the folder to guard; made if absent, and holds the process id of the last holder.

    Raises
    ------
    FolderInUseError : another process holds it, or this one does already.
    OSError : it cannot be made or written; it is not held.
    """

    def __init__(self, path: Path) -> None:
        self._handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            if fcntl is not None:
                fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(self._handle, 20, 0).decode(errors="replace").strip()
            os.close(self._handle)
            raise FolderInUseError(f"{path.parent}/ is in use by process {holder or 'unknown'}") from None
        try:
            name = f"{os.getpid()}\n".encode()
            with writing(path, len(name)):
                os.ftruncate(self._handle, 0)
                os.pwrite(self._handle, name, 0)
        except OSError as fault:
            os.close(self._handle)
            if fault.filename is not None:
                raise
            raise OSError(fault.errno, fault.strerror, str(path)) from None

    def release(self) -> None:
        """Let others in; may be called twice."""
        if self._handle >= 0:
            os.close(self._handle)
            self._handle = -1


def holder(path: Path) -> int | None:
    """Return the id of the process that holds the lock at `path`; None where nobody does."""
    try:
        handle = os.open(path, os.O_RDONLY)
    except FileNotFoundError:
        return None
    try:
        if fcntl is not None:
            fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        text = os.pread(handle, 20, 0).decode(errors="replace").strip()
        return int(text) if text.isdigit() else None
    finally:
        os.close(handle)
    return None
