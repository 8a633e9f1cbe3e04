"""Another program's HDF5 file, read in a process of its own: the library crashes on some that are damaged."""

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ctlblocks.recording import Recording, RecordingError
from rigkit.sealed_file import UNREADABLE, whole

PATIENCE = 300.0
"""s for a file to be read."""


def read_hdf5(path: Path, channels: Sequence[str], rate: float | None) -> Recording:
    """Read channels from an HDF5 file in the order they are asked for.

    Parameters
    ----------
    path : Path
    channels : sequence of str
        The paths of datasets, with ":" and a column's number where one has several.
    rate : float or None, samples/s
        Where the file has no attribute "rate", of its own or of a dataset.

    Raises
    ------
    RecordingError : no such file or dataset, a damaged one, no rate, or values that are not finite.
    """
    command = [sys.executable, "-m", __name__, str(path), *channels]
    try:
        done = subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise RecordingError(f"{path}: is not read within {PATIENCE:g} s, it is damaged or too large") from None
    first, _, content = done.stdout.partition(b"\n")
    if done.returncode:
        raise RecordingError(f"{path}: the HDF5 library fails on it ({done.returncode}), it is damaged or too large")
    about = json.loads(first)
    if "refused" in about:
        raise RecordingError(f"{path}: {about['refused']}")
    said = rate if about["rate"] is None else float(about["rate"])
    if said is None:
        raise RecordingError(f"{path}: does not say its rate: give that, or a column of time in s")
    data = np.frombuffer(content).reshape(len(channels), -1).T
    if not (finite := np.isfinite(data).all(axis=1)).all():
        raise RecordingError(f"{path}: sample {int(finite.argmin())} is not finite")
    try:
        return Recording(tuple(channels), tuple(about["units"]), said, data)
    except RecordingError as fault:
        raise RecordingError(f"{path}: {fault}") from None


class _RefusedError(ValueError):
    """What is wrong with a file, in words."""


def _columns(path: Path, channels: Sequence[str]) -> tuple[dict[str, Any], np.ndarray]:
    """Read channels: their units and rate, and their samples, shape (channels, samples)."""
    with h5py.File(path, "r") as file:
        columns = [_column(file, channel) for channel in channels]
        said = file.attrs.get("rate", next((own for *_, own in columns if own is not None), None))
    lengths = {channel: len(values) for channel, (values, *_) in zip(channels, columns, strict=True)}
    if len(set(lengths.values())) > 1:
        differing = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise _RefusedError(f"the datasets have different lengths, {differing}")
    try:
        rate = None if said is None else float(np.asarray(said).item())
    except (ValueError, TypeError):
        raise _RefusedError(f"its rate is {said!r}, must be a number of samples/s") from None
    return {"rate": rate, "units": [unit for _, unit, _ in columns]}, np.array([values for values, *_ in columns])


def _column(file: h5py.File, channel: str) -> tuple[np.ndarray, str, Any]:
    """Return samples, unit and rate of one channel."""
    place, _, column = channel.partition(":")
    dataset = file.get(place)
    if not isinstance(dataset, h5py.Dataset) or dataset.ndim not in (1, 2) or dataset.dtype.kind not in "fiu":
        there: list[str] = []
        file.visititems(lambda name, item: there.append(name) if isinstance(item, h5py.Dataset) else None)
        raise _RefusedError(f"no dataset {place!r} of numbers in one or two dimensions; there are {', '.join(there)}")
    table = whole(dataset).astype(float)
    table = table[:, None] if table.ndim == 1 else table
    if not column and table.shape[1] == 1:
        column = "1"
    if not (column.isdecimal() and 1 <= int(column) <= table.shape[1]):
        raise _RefusedError(f"{channel!r} must name one of {table.shape[1]} columns, as {place}:1")
    unit = dataset.attrs.get("unit", dataset.attrs.get("units", "1"))
    return table[:, int(column) - 1], str(unit), dataset.attrs.get("rate")


def _answer(path: Path, channels: Sequence[str]) -> None:
    try:
        about, data = _columns(path, channels)
    except _RefusedError as fault:
        about, data = {"refused": str(fault)}, np.zeros(0)
    except UNREADABLE as fault:
        words = " ".join(str(fault).split())
        about, data = {"refused": f"is no HDF5 file, or a damaged one ({words})"}, np.zeros(0)
    sys.stdout.buffer.write(json.dumps(about).encode() + b"\n" + data.tobytes())


if __name__ == "__main__":
    _answer(Path(sys.argv[1]), sys.argv[2:])
