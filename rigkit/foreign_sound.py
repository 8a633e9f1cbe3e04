"""Sounds of anybody's as signals: WAV, RF64 and FLAC, header and samples checked against each other."""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import soundfile

from ctlblocks import wav_file
from ctlblocks.recording import RecordingError
from rigkit.flac_header import FlacHeader, flac_header
from rigkit.foreign_stream import Signals, frames_at_once

SUFFIXES = (".wav", ".flac")


def sound_signals(path: Path) -> Signals:
    """Open a sound; its channels are "channel_1", "channel_2", ... of unit "1" where it names none.

    Parameters
    ----------
    path : Path, ending in .wav or .flac

    Raises
    ------
    RecordingError : no sound, or one whose header contradicts the file.
    """
    try:
        if path.suffix.lower() == ".flac":
            flac = flac_header(path)
            return _unnamed(path, flac.channels, flac.rate, flac.frames, lambda: _flac_parts(path, flac))
        said = wav_file.header(path)
        found = _unnamed(path, said.channels, said.rate, said.frames, lambda: _wav_parts(path))
        return replace(found, **_described(said.about)) if said.about else found
    except (OSError, ValueError, TypeError, KeyError, RecursionError, soundfile.SoundFileError) as fault:
        raise fault if isinstance(fault, RecordingError) else RecordingError(f"{path}: {fault}") from None


def _unnamed(
    path: Path, channels: int, rate: float, frames: int, source: Callable[[], Iterator[np.ndarray]]
) -> Signals:
    names, columns = tuple(f"channel_{number + 1}" for number in range(channels)), tuple(range(channels))
    return Signals(path, names, ("1",) * channels, float(rate), frames, source, columns)


def _described(about: Mapping[str, Any]) -> dict[str, Any]:
    return {"names": tuple(about["names"]), "units": tuple(about["units"]), "provenance": about["provenance"]}


def _wav_parts(path: Path) -> Iterator[np.ndarray]:
    return _parts(path, "float64")


def _flac_parts(path: Path, said: FlacHeader) -> Iterator[np.ndarray]:
    """Read samples, and compare their checksum with that of what was written: the library skips what is damaged."""
    checksum = hashlib.md5(usedforsecurity=False)
    for part in _parts(path, "int32"):
        checksum.update(said.packed(part))
        yield part * 2.0**-31
    if said.checksum not in (None, checksum.digest()):
        raise RecordingError(f"{path}: its samples are not those that were written: their checksum is another")


def _parts(path: Path, dtype: str) -> Iterator[np.ndarray]:
    done = 0
    try:
        with soundfile.SoundFile(path) as file:
            size = frames_at_once(file.channels)
            while len(part := file.read(size, dtype=dtype, always_2d=True)):
                done += len(part)
                yield part
    except (OSError, soundfile.SoundFileError) as fault:
        raise RecordingError(f"{path}: is damaged behind sample {done} ({fault})") from None


def is_of_integers(path: Path) -> bool:
    """Whether a readable sound is of integers, whose numbers are parts of a full scale that it does not say."""
    return path.suffix.lower() == ".flac" or wav_file.header(path).subtype.startswith("PCM")
