"""The process that reads an HDF5 file of anybody's: `python -m rigkit.array_reader FILE CHANNELS`, to standard output.

A line of JSON (names, units, rate and frames of the channels, or why they are refused), then their samples as float64,
frame by frame.
"""

import json
import resource
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rigkit.foreign_stream import BLOCK
from rigkit.sealed_file import UNREADABLE

PATIENCE = 60
"""s of the processor's time for a block to be read."""
COMPRESSED = 1100
"""How many times as large as its file a dataset may be: deflate makes of a byte no more than 1032."""
LARGEST_CHUNK = 2**28
"""Bytes of a chunk, which the library reads whole."""
WIDEST = 1024
"""Columns of a dataset."""


class RefusedError(ValueError):
    """What is wrong with a file, in words."""


@dataclass(frozen=True)
class Column:
    """One channel: a dataset, and which of its columns."""

    name: str
    dataset: h5py.Dataset
    number: int

    def samples(self, start: int, stop: int) -> np.ndarray:
        """Return samples, shape (stop - start,), any unit."""
        where = slice(start, stop) if self.dataset.ndim == 1 else (slice(start, stop), self.number)
        found: np.ndarray = self.dataset[where].astype(float)
        return found


def main(path: Path, channels: Sequence[str] | None) -> None:
    """Write what the channels are and hold."""
    try:
        with h5py.File(path, "r") as file:
            columns = [_column(file, channel) for channel in channels] if channels is not None else _all(file)
            about = _about(file, columns)
            sys.stdout.buffer.write(json.dumps(about).encode() + b"\n")
            _write(columns, about["frames"])
    except RefusedError as fault:
        _refuse(str(fault))
    except UNREADABLE as fault:
        _refuse(f"is no HDF5 file, or a damaged one ({' '.join(str(fault).split())})")


def _refuse(reason: str) -> None:
    """Say why; behind samples it is none, and they end too early."""
    sys.stdout.buffer.write(json.dumps({"refused": reason}).encode() + b"\n")


def _about(file: h5py.File, columns: Sequence[Column]) -> dict[str, Any]:
    lengths = {column.name: len(column.dataset) for column in columns}
    if len(set(lengths.values())) > 1:
        differing = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise RefusedError(f"the datasets have different lengths, {differing}")
    own = (column.dataset.attrs.get("rate") for column in columns)
    said = file.attrs.get("rate", next((rate for rate in own if rate is not None), None))
    try:
        rate = None if said is None else float(np.asarray(said).item())
    except (ValueError, TypeError):
        raise RefusedError(f"its rate is {said!r}, must be a number of samples/s") from None
    units = [str(attrs.get("unit", attrs.get("units", "1"))) for attrs in (column.dataset.attrs for column in columns)]
    return {"names": list(lengths), "units": units, "rate": rate, "frames": lengths[columns[0].name]}


def _write(columns: Sequence[Column], frames: int) -> None:
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    for start in range(0, frames, BLOCK):
        used = resource.getrusage(resource.RUSAGE_SELF)
        resource.setrlimit(resource.RLIMIT_CPU, (int(used.ru_utime + used.ru_stime) + PATIENCE, hard))
        block = np.stack([column.samples(start, min(start + BLOCK, frames)) for column in columns], axis=1)
        sys.stdout.buffer.write(block.tobytes())


def _all(file: h5py.File) -> list[Column]:
    """Return every column of every dataset of numbers."""
    found: list[h5py.Dataset] = []
    file.visititems(lambda _, item: found.append(item) if _holds_signals(item) else None)
    if not found:
        raise RefusedError("holds no dataset of numbers in one or two dimensions")
    columns = []
    for dataset in found:
        _refuse_too_large(dataset)
        name, width = str(dataset.name).removeprefix("/"), 1 if dataset.ndim == 1 else dataset.shape[1]
        columns += [Column(f"{name}_{n + 1}" if width > 1 else name, dataset, n) for n in range(width)]
    return columns


def _column(file: h5py.File, channel: str) -> Column:
    """Return the column of a channel that is asked for."""
    place, _, number = channel.partition(":")
    dataset = file.get(place)
    if not _holds_signals(dataset):
        there: list[str] = []
        file.visititems(lambda name, item: there.append(name) if isinstance(item, h5py.Dataset) else None)
        raise RefusedError(f"no dataset {place!r} of numbers in one or two dimensions; there are {', '.join(there)}")
    _refuse_too_large(dataset)
    width = 1 if dataset.ndim == 1 else dataset.shape[1]
    number = number or ("1" if width == 1 else "")
    if not (number.isdecimal() and 1 <= int(number) <= width):
        raise RefusedError(f"{channel!r} must name one of {width} columns, as {place}:1")
    return Column(channel, dataset, int(number) - 1)


def _holds_signals(item: object) -> bool:
    return isinstance(item, h5py.Dataset) and item.ndim in (1, 2) and item.dtype.kind in "fiu"


def _refuse_too_large(dataset: h5py.Dataset) -> None:
    """Refuse what cannot be in the file, or is not read in blocks."""
    size, width = dataset.file.id.get_filesize(), 1 if dataset.ndim == 1 else dataset.shape[1]
    largest = size if dataset.chunks is None else COMPRESSED * size
    if dataset.nbytes > largest:
        raise RefusedError(f"{dataset.name} has {dataset.nbytes} bytes, in a file of {size}")
    if width > WIDEST:
        raise RefusedError(f"{dataset.name} has {width} columns, must be <= {WIDEST}: time goes along its first axis")
    if dataset.chunks is not None and np.prod(dataset.chunks, dtype=float) * dataset.dtype.itemsize > LARGEST_CHUNK:
        raise RefusedError(f"{dataset.name} has chunks of {dataset.chunks}, must be <= {LARGEST_CHUNK} bytes")


if __name__ == "__main__":
    main(Path(sys.argv[1]), json.loads(sys.argv[2]))
