"""Sounds of anybody's as signals: WAV, RF64 and FLAC, header and samples checked against each other."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import soundfile

from ctlblocks import wav_file
from ctlblocks.recording import RecordingError
from rigkit.foreign_stream import BLOCK, Signals

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
        said = wav_file.header(path) if path.suffix.lower() == ".wav" else _flac(path)
        unnamed: dict[str, Any] = {
            "names": [f"channel_{number + 1}" for number in range(said.channels)], "units": ["1"] * said.channels,
            "provenance": {},
        }  # fmt: skip
        about = unnamed | said.about
        names, units = tuple(about["names"]), tuple(about["units"])
    except (OSError, ValueError, TypeError, KeyError, RecursionError, soundfile.SoundFileError) as fault:
        raise RecordingError(f"{path}: {fault}") from None
    columns = tuple(range(said.channels))
    return Signals(
        path, names, units, float(said.rate), said.frames, lambda: _parts(path), columns, about["provenance"]
    )


def _parts(path: Path) -> Iterator[np.ndarray]:
    try:
        with soundfile.SoundFile(path) as file:
            while len(part := file.read(BLOCK, dtype="float64", always_2d=True)):
                yield part
    except (OSError, soundfile.SoundFileError) as fault:
        raise RecordingError(f"{path}: {fault}") from None


def is_of_integers(path: Path) -> bool:
    """Whether a readable sound is of integers, whose numbers are parts of a full scale that it does not say."""
    return path.suffix.lower() == ".flac" or wav_file.header(path).subtype.startswith("PCM")


def _flac(path: Path) -> wav_file.Header:
    with soundfile.SoundFile(path) as file:
        if file.format != "FLAC":
            raise ValueError(f"is {file.format}, must be FLAC")
        return wav_file.Header(file.frames, file.channels, file.samplerate, file.subtype, {})
