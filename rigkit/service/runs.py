"""What has been recorded, for whoever wants to have it: folders of runs, and the files in them."""

import os
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from rigkit.service.paths import confined


def listed(root: Path) -> list[dict[str, Any]]:
    """Return name and time of each run's folder, the newest first.

    Parameters
    ----------
    root : Path
        Folder of runs; none is a folder without any.
    """
    held = [path for path in root.iterdir() if _is_shown(path.name) and path.is_dir()] if root.is_dir() else []
    changed = sorted(((path.stat().st_mtime, path.name) for path in held), reverse=True)
    return [{"name": name, "time": _text(time)} for time, name in changed]


def files(root: Path, run: str) -> list[dict[str, Any]]:
    """Return path, size (bytes) and time of each file of a run, by path; what is hidden or leads out is none of them.

    Parameters
    ----------
    root : Path
    run : str
        Name of its folder.

    Raises
    ------
    PermissionError : the name leads out of the runs.
    LookupError : there is no such run.
    """
    folder = confined(root, run)
    if not folder.is_dir():
        raise LookupError(f"there is no run {run[:80]!r}")
    return sorted(_below(folder, root), key=lambda file: str(file["path"]))


def file(root: Path, run: str, text: str) -> Path:
    """Return where a file of a run is.

    Raises
    ------
    PermissionError : it is outside of the runs, or hidden.
    LookupError : there is no such file.
    """
    path = confined(root, f"{run}/{text}")
    if not path.is_file():
        raise LookupError(f"there is no file {text[:200]!r} in the run {run[:80]!r}")
    return path


def _below(folder: Path, root: Path) -> Iterator[dict[str, Any]]:
    for place, folders, names in os.walk(folder):
        folders[:] = filter(_is_shown, folders)
        for name in filter(_is_shown, names):
            path = Path(place, name)
            try:
                confined(root, str(path.relative_to(root)))
                told = path.stat()
            except OSError:  # it leads out, or has just gone
                continue
            yield {"path": str(path.relative_to(folder)), "size": told.st_size, "time": _text(told.st_mtime)}


def _is_shown(name: str) -> bool:
    """Whether a name is neither hidden nor of bytes that are no text."""
    return not name.startswith(".") and name.isprintable()


def _text(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat(timespec="milliseconds")
