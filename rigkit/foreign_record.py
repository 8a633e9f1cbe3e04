"""Anybody's measurement as signals: opened by its suffix, read block by block or whole."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ctlblocks.recording import Recording, RecordingError
from rigkit import foreign_arrays, foreign_mcap, foreign_parquet, foreign_sound, foreign_table, os_fault
from rigkit.even_time import STEADY, seconds_of
from rigkit.foreign_stream import Signals

_CHOSEN = (*foreign_arrays.SUFFIXES, *foreign_mcap.SUFFIXES)
"""Of files whose reader reads no other channels than those that are asked for."""
SUFFIXES = (*foreign_sound.SUFFIXES, *foreign_table.SUFFIXES, *foreign_parquet.SUFFIXES, *_CHOSEN)


def open_signals(
    path: Path,
    rate: float | None = None,
    channels: Sequence[str] | None = None,
    asked: str = "must be",
    may_miss: bool = False,
) -> Signals:
    """Open a file of signals of one rate and length, to be read block by block.

    Parameters
    ----------
    path : Path
        A sound (.wav, also RF64; .flac), a table (.csv, .tsv, .txt, .dat: names first, or none; comma, semicolon, tab
        or spaces between; .lvm; .parquet), arrays (.h5, .hdf5, .he5, .mat), messages (.mcap).
    rate : float or None, samples/s
        None: what the file says: a sound's, a column of time, a first line of this program, an attribute "rate".
    channels : sequence of str or None
        Names, or numbers from 1, in the order that is wanted; in HDF5 the paths of datasets, with ":" and a column's
        number where one has several, in MCAP "/topic.field" or "/topic.field[2]".  None: all but a column of time.
    asked : str
        What an error says before `rate`.
    may_miss : bool
        Whether samples may be missing, which are NaN.

    Returns
    -------
    Signals
        Nothing but the head has been read, and of a table with a column of time every row.

    Raises
    ------
    RecordingError : no such file, a suffix that is none of these, a head that is damaged, a channel that is not in it,
        no rate, another one, or none but time.
    """
    kind = path.suffix.lower()
    if path.is_dir():
        raise RecordingError(f"{path}: is a folder, must be a file")
    if not path.is_file():
        raise RecordingError(f"{path}: there is no such file")
    try:
        if kind in foreign_arrays.SUFFIXES:
            found = foreign_arrays.array_signals(path, channels, rate)
        elif kind in foreign_table.SUFFIXES:
            found = foreign_table.table_signals(path, rate, may_miss)
        elif kind in foreign_parquet.SUFFIXES:
            found = foreign_parquet.parquet_signals(path, rate)
        elif kind in foreign_mcap.SUFFIXES:
            found = foreign_mcap.mcap_signals(path, channels, rate)
        elif kind in foreign_sound.SUFFIXES:
            found = foreign_sound.sound_signals(path)
        else:
            raise RecordingError(f"{path}: suffix is {path.suffix!r}, must be one of {', '.join(SUFFIXES)}")
    except OSError as fault:
        raise RecordingError(os_fault.told(fault)) from None
    found = replace(found, may_miss=may_miss)
    if rate is not None and not abs(found.rate - rate) <= STEADY * rate:
        raise RecordingError(f"{path}: {found.rate:.9g} samples/s, {asked} {rate:.9g}")
    if channels is not None:
        return found if kind in _CHOSEN else found.select(channels)
    signals = [name for name in found.names if seconds_of(name, "1") is None]
    if not signals:
        raise RecordingError(f"{path}: holds nothing but {', '.join(found.names)}")
    return found.select(signals)


def read_channels(path: Path, channels: Sequence[str], rate: float | None, may_miss: bool = False) -> Recording:
    """Read channels from a file in the order they are asked for, whole.

    Parameters
    ----------
    path : Path
        As of `open_signals`.
    channels : sequence of str
    rate : float or None, samples/s
        As given by --rate.
    may_miss : bool, optional
        Whether samples may be missing, which are NaN.

    Raises
    ------
    RecordingError : as of `open_signals`, and what is found while it is read.
    """
    return open_signals(path, rate, channels, "--rate says", may_miss).whole()


def read_signals(path: Path, rate: float | None = None) -> Recording:
    """Read all signals of a file but a column of time, whole.

    Parameters
    ----------
    path : Path
        As of `open_signals`.
    rate : float or None, samples/s
        None: what the file says.

    Raises
    ------
    RecordingError : as of `open_signals`, and what is found while it is read.
    """
    return open_signals(path, rate).whole()


def is_sound(path: Path) -> bool:
    """Whether a file is a sound, whose numbers are parts of a full scale unless it says their unit."""
    return path.suffix.lower() in foreign_sound.SUFFIXES


def is_of_integers(path: Path) -> bool:
    """Whether a file is a sound of integers, whose numbers are parts of a full scale that it does not say."""
    return is_sound(path) and foreign_sound.is_of_integers(path)
