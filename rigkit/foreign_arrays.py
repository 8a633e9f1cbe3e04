"""Another program's HDF5 or MAT file as signals, read in a process of its own: libraries crash on damaged ones."""

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.foreign_stream import Signals, frames_at_once

SUFFIXES = (".h5", ".hdf5", ".he5", ".mat")
READER = "rigkit.array_reader"


def array_signals(path: Path, channels: Sequence[str] | None, rate: float | None) -> Signals:
    """Open an HDF5 or MAT file.

    Parameters
    ----------
    path : Path
    channels : sequence of str or None
        The names of arrays of numbers, with ":" and a column's number where one has several; None: all but time.
    rate : float or None, samples/s
        Where the file says none.

    Raises
    ------
    RecordingError : no such array, a damaged file, no rate or two, or several lengths.
    """
    with _asked(path, channels) as (about, pipe):
        names, frames = tuple(about["names"]), int(about["frames"])
        first = next(_parts(path, pipe, len(names)), np.empty((0, len(names))))
    said = rate if about["rate"] is None else float(about["rate"])
    if said is None:
        raise RecordingError(f"{path}: does not say its rate: give that, or a column of time in s")

    def source() -> Iterator[np.ndarray]:
        if len(first) == frames:
            yield first
            return
        with _asked(path, channels) as (_, pipe):
            yield from _parts(path, pipe, len(names))

    return Signals(path, names, tuple(about["units"]), said, frames, source, tuple(range(len(names))))


@contextmanager
def _asked(path: Path, channels: Sequence[str] | None) -> Iterator[tuple[dict[str, Any], IO[bytes]]]:
    """Start the process; give what it says of the channels, and the pipe that their samples come from."""
    reader = started(path, channels)
    with reader:
        assert reader.stdout is not None
        try:
            first = reader.stdout.readline()
            if not first.endswith(b"\n"):
                raise RecordingError(f"{path}: its library fails on it ({reader.wait()}), it is damaged or too large")
            about = json.loads(first)
            if "refused" in about:
                raise RecordingError(f"{path}: {about['refused']}")
            yield about, reader.stdout
        finally:
            reader.kill()


def started(path: Path, channels: Sequence[str] | None) -> subprocess.Popen[bytes]:
    """Start the process that reads a file."""
    command = [sys.executable, "-m", READER, str(path), json.dumps(channels)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)


def _parts(path: Path, pipe: IO[bytes], width: int) -> Iterator[np.ndarray]:
    """Read blocks of samples; what is missing in the end is found by who counts them."""
    while content := pipe.read(8 * width * frames_at_once(width)):
        if len(content) % (8 * width):
            raise RecordingError(f"{path}: its library fails on it, it is damaged or too large")
        yield np.frombuffer(content).reshape(-1, width)
