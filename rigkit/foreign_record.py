"""Anybody's measurement, CSV, WAV or HDF5, as a recording of the channels that are asked for."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ctlblocks import recording, wav_file
from ctlblocks.recording import Recording, RecordingError
from rigkit.foreign_hdf5 import read_hdf5
from rigkit.text_file import TextFault, read_text

TIME = ("t", "time", "zeit", "tid", "seconds")
"""Names, in small letters and without a unit, of a column that holds the time in seconds."""

STEADY = 1e-3
"""Part by which a rate that is given may differ from the file's."""

UNEVEN = 0.5
"""Part of a sample period by which a step of time may be too long or too short: rounded, but no sample lost."""

HDF5 = (".h5", ".hdf5", ".he5")
SOUNDS = (".wav", ".flac")


def read_channels(path: Path, channels: Sequence[str], rate: float | None) -> Recording:
    """Read channels from a file in the order they are asked for.

    Parameters
    ----------
    path : Path
        Ends in .csv or .txt (a row of names first, or none; comma, semicolon, tab or spaces between), .wav, or .h5.
    channels : sequence of str
        Names, or numbers from 1; in HDF5 the paths of datasets, with ":" and a column's number where one has several.
    rate : float or None, samples/s
        None: what the file says: a WAV's, a CSV's own first line or its column of time, an HDF5's attribute "rate".

    Raises
    ------
    RecordingError : a file that is not there or not whole, a channel that is not in it, no rate, or two.
    """
    if not path.is_file():
        raise RecordingError(f"{path}: there is no such file")
    if path.suffix.lower() in HDF5:
        found = read_hdf5(path, channels, rate)
    else:
        found = _from_table(path, rate)
        found = found.select([_named(path, found, channel) for channel in channels])
    if rate is not None and not abs(found.rate - rate) <= STEADY * rate:
        raise RecordingError(f"{path}: {found.rate:.9g} samples/s, --rate says {rate:.9g}")
    return found


def read_signals(path: Path, rate: float | None = None) -> Recording:
    """Read all of a CSV or WAV file but a column of time.

    Parameters
    ----------
    path : Path
        As for `read_channels`, but no HDF5.
    rate : float or None, samples/s
        None: what the file says.

    Raises
    ------
    RecordingError : a file that is not there or not whole, no rate or another one, nothing but time.
    """
    if not path.is_file():
        raise RecordingError(f"{path}: there is no such file")
    found = _from_table(path, rate)
    if rate is not None and not abs(found.rate - rate) <= STEADY * rate:
        raise RecordingError(f"{path}: {found.rate:.9g} samples/s, must be {rate:.9g}")
    signals = [name for name in found.names if name.lower() not in TIME]
    if not signals:
        raise RecordingError(f"{path}: holds nothing but {', '.join(found.names)}")
    return found.select(signals)


def is_of_integers(path: Path) -> bool:
    """Whether a file is a WAV of integers, whose numbers are parts of a full scale that it does not say."""
    return path.suffix.lower() == ".wav" and wav_file.subtype(path).startswith("PCM")


def is_sound(path: Path) -> bool:
    """Whether a file is a sound, whose numbers are parts of a full scale unless it says their unit."""
    return path.suffix.lower() in SOUNDS


def _named(path: Path, found: Recording, channel: str) -> str:
    """Return the name of a channel given by name or number."""
    if channel in found.names:
        return channel
    if channel.isdecimal() and 1 <= int(channel) <= len(found.names):
        return found.names[int(channel) - 1]
    raise RecordingError(
        f"{path}: no channel {channel!r}; there are {', '.join(found.names)}, or the numbers 1 to {len(found.names)}"
    )


def _from_table(path: Path, rate: float | None) -> Recording:
    """Read all of a WAV, of a CSV that this program wrote, or of another table."""
    if path.suffix.lower() not in (".csv", ".txt", ".dat", ".tsv"):
        return recording.read(path)
    with path.open("rb") as file:
        if path.suffix.lower() == ".csv" and file.read(1) == b"#":
            return recording.read(path)
    try:
        lines = read_text(path).splitlines()
    except TextFault as fault:
        raise RecordingError(str(fault)) from None
    rows = [(number, line) for number, line in enumerate(lines, start=1) if line.strip() and not line.startswith("#")]
    if len(rows) < 2:
        raise RecordingError(f"{path}: has {len(rows)} rows, must have at least 2")
    between = _separator(rows[0][1])
    first = _cells(rows[0][1], between)
    has_names = not all(map(_is_number, first))
    if has_names and any(_is_number(cell) and not cell.isdecimal() for cell in first):
        raise RecordingError(f"{path}: row {rows[0][0]} is {rows[0][1][:60]!r}, must be names, or numbers")
    names = first if has_names else [f"channel_{number + 1}" for number in range(len(first))]
    data = np.array([_numbers(path, number, line, between, len(names)) for number, line in rows[has_names:]])
    heads = [name.strip().removesuffix("]").partition("[") for name in names]
    plain, units = tuple(head.strip() for head, _, _ in heads), tuple(unit.strip() or "1" for _, _, unit in heads)
    sampled = _rate(path, plain, data, rate)
    try:
        return Recording(plain, units, sampled, data)
    except RecordingError as fault:
        raise RecordingError(f"{path}: {fault}") from None


def _separator(line: str) -> str | None:
    """Return what stands between cells, None for spaces."""
    return next((mark for mark in (";", "\t", ",") if mark in line), None)


def _cells(line: str, between: str | None) -> list[str]:
    cells = next(csv.reader([line], delimiter=between)) if between else line.split()
    return [cell.strip() for cell in cells]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return cell.isascii() and "_" not in cell  # float() takes 1_0, and the digits of every script


def _numbers(path: Path, row: int, line: str, between: str | None, width: int) -> list[float]:
    cells = _cells(line, between)
    if len(cells) != width:
        raise RecordingError(f"{path}: row {row} has {len(cells)} cells, must have {width}")
    for column, cell in enumerate(cells, start=1):
        if not (_is_number(cell) and np.isfinite(float(cell))):
            raise RecordingError(f"{path}: row {row}, column {column}: {cell!r}, must be a finite number")
    return [float(cell) for cell in cells]


def _rate(path: Path, names: Sequence[str], data: np.ndarray, rate: float | None) -> float:
    """Return the rate: that of a column of time, or the one given."""
    timed = [number for number, name in enumerate(names) if name.lower() in TIME]
    if not timed:
        if rate is None:
            raise RecordingError(f"{path}: does not say its rate: give that, or a column of time in s")
        return rate
    if len(data) < 2:
        raise RecordingError(f"{path}: has 1 row of numbers, must have at least 2 to tell the rate")
    time = data[:, timed[0]]
    period = float(time[-1] - time[0]) / (len(time) - 1)
    if not (period > 0 and np.abs(np.diff(time) - period).max() <= UNEVEN * period):
        raise RecordingError(f"{path}: {names[timed[0]]!r} does not rise in even steps, must be sampled evenly")
    return rate if rate is not None and abs(period * rate - 1) <= STEADY else 1 / period
