"""A lock on what there is once on a machine, such as a device or an address: held by one process, from any folder."""

import hashlib
import os
import re
import sys
import tempfile
from datetime import datetime
from pathlib import Path

from rigkit.json_file import JsonError, json_value
from rigkit.json_text import json_text
from rigkit.posix import fcntl, refuse_without

FOLDER = "VIBROSTAGE_LOCKS"
"""Names, in the environment, the folder of the locks; without it, one that all users of the machine share."""
_LONGEST = 4096


class DeviceInUseError(OSError):
    """Another process has what is there once."""


class MachineLock:
    """Hold what `name` names, until `release`, or until this process ends however it does.

    Parameters
    ----------
    name : str
        The same for whoever opens the same thing, whatever the rig file and the folder.

    Raises
    ------
    DeviceInUseError : another process holds it, or this one does already; it says which, and since when.
    OSError : the folder of the locks cannot be used, or the system has no locks.
    """

    def __init__(self, name: str) -> None:
        refuse_without(fcntl, f"file locks, by which {name} is held alone")
        path = _path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.parent.stat().st_uid == os.getuid():
            path.parent.chmod(0o1777)
        self._handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        try:
            fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            told = _told(self._handle)
            self.release()
            who = f"process {told['pid']} ({told['command']}), since {told['since']}" if told else "another process"
            raise DeviceInUseError(f"{name} is in use by {who}") from None
        since = datetime.now().astimezone().isoformat(timespec="seconds")
        told = {"pid": os.getpid(), "command": _command(), "since": since, "name": name}
        os.ftruncate(self._handle, 0)
        os.pwrite(self._handle, json_text(told).encode(), 0)

    def release(self) -> None:
        """Let others have it; may be called twice."""
        if self._handle >= 0:
            os.close(self._handle)
            self._handle = -1


def holder_of(name: str) -> int | None:
    """Return the id of the process that holds what `name` names; None where nobody does, or nobody to be trusted.

    The file is another's to write where it is not this user's, or root's.
    """
    if fcntl is None:
        return None
    try:
        handle = os.open(_path(name), os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError:
        return None
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        told = _told(handle)
        return int(told["pid"]) if told and os.fstat(handle).st_uid in (0, os.getuid()) else None
    finally:
        os.close(handle)
    return None


def _path(name: str) -> Path:
    shared = Path("/run/lock") if os.access("/run/lock", os.W_OK) else Path(tempfile.gettempdir())
    folder = Path(os.environ.get(FOLDER) or shared / "vibrostage")
    readable = re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-")[:60]
    return folder / f"{readable}-{hashlib.sha256(name.encode()).hexdigest()[:12]}.lock"


def _told(handle: int) -> dict[str, int | str] | None:
    """Return who says to hold it."""
    try:
        told = json_value(os.pread(handle, _LONGEST, 0).decode(errors="replace"), "lock", dict)
    except JsonError:
        return None
    kinds = {"pid": int, "command": str, "since": str}
    return told if all(isinstance(told.get(key), kind) for key, kind in kinds.items()) else None


def _command() -> str:
    return " ".join([Path(sys.argv[0]).name, *sys.argv[1:]])[:200]
