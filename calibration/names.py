"""Names that a calibration writes to: what is read is not written, and what is there is set aside under its date."""

import shutil
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from rigkit.lock import Lock
from rigkit.origin import RUN, read_origin

LOCK = ".lock"


class OutputError(ValueError):
    """A name that a calibration may not write to."""


def raw_folder(out: Path) -> Path:
    """Return the folder of a model file's recordings, `out` with the suffix .raw.

    Raises
    ------
    OutputError : the model would not be an .h5 file, or there is no folder for it.
    """
    if not out.parent.is_dir():
        raise OutputError(f"{out}: there is no folder {out.parent}")
    if out.suffix != ".h5":
        raise OutputError(f"{out}: the suffix is {out.suffix!r}, must be '.h5'")
    return out.with_suffix(".raw")


def refuse_inputs(results: Sequence[Path], inputs: Sequence[Path | None]) -> None:
    """Refuse to write a file that the command was given to read.

    Raises
    ------
    OutputError : it names the file.
    """
    given = {path.resolve() for path in inputs if path is not None}
    for path in results:
        if path.resolve() in given:
            raise OutputError(f"{path}: would be written, and was given to be read; choose another name for --out")


def refuse_taken(results: Sequence[Path], again: bool) -> None:
    """Refuse to write over a result that no recordings of its own stand beside.

    Parameters
    ----------
    results : sequence of Path
        The model first.
    again : bool
        Whether those that are there are set aside; they are, by this call.

    Raises
    ------
    OutputError : one is there.
    """
    there = [path for path in results if path.exists()]
    if there and not again:
        raise OutputError(f"{there[0]}: is there already; choose another name, or keep it under its date with --again")
    if there:
        set_aside(results[0], raw_folder(results[0]), there)


def set_aside(out: Path, raw: Path, paths: Sequence[Path]) -> None:
    """Rename what a calibration has left, together, to names with its date."""
    lock = Lock(raw / LOCK) if raw.is_dir() else None
    try:
        origin = read_origin(raw / RUN)
        date = datetime.fromisoformat(origin.measured if origin is not None else oldest(paths[0]))
        stem, number = f"{out.stem}-{date:%Y%m%d-%H%M%S}", 1
        while any(_renamed(path, out.stem, stem).exists() for path in paths):
            number += 1
            stem = f"{out.stem}-{date:%Y%m%d-%H%M%S}-{number}"
        for path in paths:
            kept = _renamed(path, out.stem, stem)
            if path.suffix == ".toml":  # a program may be running with it, and is started with it again
                shutil.copy2(path, kept)
            else:
                path.rename(kept)
    finally:
        if lock is not None:
            lock.release()


def _renamed(path: Path, before: str, after: str) -> Path:
    return path.with_name(f"{after}{path.name.removeprefix(before)}")


def oldest(path: Path) -> str:
    """Return when the oldest file of a folder, or a file, was written, UTC."""
    files = [file for file in path.rglob("*") if file.is_file()] if path.is_dir() else [path]
    oldest = min((file.stat().st_mtime for file in files), default=0.0)
    return datetime.fromtimestamp(oldest, UTC).isoformat(timespec="seconds")
