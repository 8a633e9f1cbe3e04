"""The process that reads a file of arrays: `python -m rigkit.array_reader FILE CHANNELS`, to standard output.

A line of JSON (names, units, rate and frames of the channels, or why they are refused), then their samples as float64,
frame by frame.
"""

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import h5py
import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.array_hdf5 import LARGEST_CHUNK, hdf5_contents
from rigkit.array_room import ROOM, let_have
from rigkit.array_variables import Column, Contents, RefusedError, chosen, rate_of
from rigkit.foreign_stream import frames_at_once
from rigkit.sealed_file import UNREADABLE


def main(path: Path, channels: Sequence[str] | None, write: Callable[[bytes], object]) -> None:
    """Write what the channels are and hold.

    Parameters
    ----------
    path : Path
    channels : sequence of str or None
        As of `rigkit.foreign_record.open_signals`.
    write : callable(bytes)
    """
    try:
        let_have(path.stat().st_size)
        if path.suffix.lower() == ".mat" and not h5py.is_hdf5(path):
            from rigkit.array_mat import mat_contents  # scipy takes as long to load as all the rest

            _send(mat_contents(path), channels, write)
        else:
            with h5py.File(path, "r") as file:
                _send(hdf5_contents(file), channels, write)
    except (RefusedError, RecordingError) as fault:
        _refuse(str(fault), write)
    except UNREADABLE as fault:
        kind = "MAT" if path.suffix.lower() == ".mat" else "HDF5"
        _refuse(f"is no {kind} file, or a damaged one ({' '.join(str(fault).split())})", write)


def _refuse(reason: str, write: Callable[[bytes], object]) -> None:
    """Say why; behind samples it is none, and they end too early."""
    write(json.dumps({"refused": reason}).encode() + b"\n")


def _send(found: Contents, channels: Sequence[str] | None, write: Callable[[bytes], object]) -> None:
    columns = chosen(found, channels)
    frames = columns[0][1].frames
    about = {
        "names": [name for name, _, _ in columns],
        "units": [variable.unit for _, variable, _ in columns],
        "rate": rate_of(found, columns),
        "frames": frames,
    }
    write(json.dumps(about).encode() + b"\n")
    size, grain = frames_at_once(len(columns)), max(variable.grain for _, variable, _ in columns)
    if grain * len(columns) <= LARGEST_CHUNK // 8:
        size = -(-size // grain) * grain  # no chunk is decompressed twice
    for start in range(0, frames, size):
        let_have(8 * max(size, grain) * len(columns), ROOM + LARGEST_CHUNK)
        write(_block(columns, start, min(start + size, frames)).tobytes())


def _block(columns: Sequence[Column], start: int, stop: int) -> np.ndarray:
    """Return samples of all channels, shape (stop - start, channels), any unit; each variable is read once."""
    read = {variable.name: variable.read(start, stop) for _, variable, _ in columns}
    return np.stack([read[variable.name][:, number] for _, variable, number in columns], axis=1, dtype=float)


if __name__ == "__main__":
    main(Path(sys.argv[1]), json.loads(sys.argv[2]), sys.stdout.buffer.write)
