"""Recordings: named signals with units, rate and provenance, written and read as WAV or CSV."""

import math
import os
import secrets
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

import numpy as np
import soundfile

from ctlblocks import csv_file, wav_file
from ctlblocks.room import bytes_of, writing

_FORMATS = {".wav": wav_file, ".csv": csv_file}


class RecordingError(ValueError):
    """A recording is not what it must be; where it is in a file, the message begins with the path."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Sampled signals side by side.  What is not as said here is refused with a RecordingError.

    Parameters
    ----------
    names, units : tuple of str
        One a channel, printable and without brackets; every name is another; "1" is the unit of a pure number.
    rate : float, samples/s, finite, > 0
    data : array, shape (frames, channels), float32 or float64
        At least one of each.  Kept as it is, not copied, and read-only from here.
    provenance : mapping of str to str
        Where it comes from.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    data: np.ndarray
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse what could not be written and read back as it is."""
        data = self.data.view()
        data.flags.writeable = False
        if data.ndim != 2 or data.size == 0 or data.dtype not in (np.float32, np.float64):
            raise RecordingError(
                f"data is {data.dtype} {data.shape}, must be float32 or float64 (frames >= 1, channels >= 1)"
            )
        for what, texts in (("names", self.names), ("units", self.units)):
            if len(texts) != data.shape[1] or not all(map(_is_plain, texts)):
                raise RecordingError(f"{what} are {texts}, must be {data.shape[1]} printable texts without brackets")
        if len(set(self.names)) < len(self.names):
            raise RecordingError(f"names are {', '.join(self.names)}, must all be different")
        if not isinstance(self.rate, int | float) or not 0 < self.rate < math.inf:
            raise RecordingError(f"rate is {self.rate!r} samples/s, must be finite and > 0")
        if not all(isinstance(text, str) for pair in dict(self.provenance).items() for text in pair):
            raise RecordingError(f"provenance is {self.provenance}, must map text to text")
        fixed = tuple(self.names), tuple(self.units), float(self.rate), data, dict(self.provenance)
        for name, value in zip(self.__match_args__, fixed, strict=True):
            object.__setattr__(self, name, value)

    def select(self, names: Sequence[str]) -> "Recording":
        """Return the channels of these names, in this order; RecordingError if there is no such channel."""
        for name in names:
            if name not in self.names:
                raise RecordingError(f"no channel {name!r}; there are {', '.join(self.names)}")
        columns = [self.names.index(name) for name in names]
        units = tuple(self.units[column] for column in columns)
        return Recording(tuple(names), units, self.rate, self.data[:, columns], self.provenance)


def read(
    path: str | os.PathLike[str],
    *,
    rate: float | None = None,
    channels: int | None = None,
    names: Sequence[str] | None = None,
) -> Recording:
    """Read a WAV or CSV file whole; its channels are "channel_1", "channel_2", ... of unit "1" where it names none.

    A file that is not there, not whole, not finite or not what is expected is a RecordingError.

    Parameters
    ----------
    path : path, ending in .wav or .csv
    rate : float, samples/s, expected, any if None
    channels : int, expected, any if None
    names : sequence of str, expected, any if None
    """
    path = Path(path)
    try:
        data, file_rate, about = _format(path).read(path)
        unnamed = {"names": [f"channel_{n + 1}" for n in range(data.shape[1])], "units": ["1"] * data.shape[1]}
        recording = Recording(rate=file_rate, data=data, **(unnamed | about))
        if not (finite := np.isfinite(data)).all():
            sample, channel = divmod(int(finite.argmin()), data.shape[1])
            name, value = recording.names[channel], data[sample, channel]
            raise RecordingError(f"channel {name!r}, sample {sample}: {value}, must be finite")
        for found, expected, what in (
            (f"{recording.rate:.15g}", rate and f"{rate:.15g}", "samples/s"),
            (str(data.shape[1]), channels and str(channels), "channels"),
            (", ".join(recording.names), names and ", ".join(names), "as names"),
        ):
            if expected and found != expected:
                raise RecordingError(f"{found} {what}, must be {expected}")
    except (OSError, ValueError, TypeError, ArithmeticError, RecursionError, soundfile.SoundFileError) as fault:
        raise _at(path, fault) from fault
    return recording


def write(path: str | os.PathLike[str], recording: Recording) -> None:
    """Write a WAV or CSV file in one step: a write that fails or is killed leaves what was there before.

    Samples keep their precision, bit for bit, in either format.  A WAV that would pass 4 GB is an RF64.  RecordingError
    says what the format or the disk cannot hold.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    about = {"names": recording.names, "units": recording.units, "provenance": recording.provenance}
    samples, channels = recording.data.shape
    try:
        layout, wanted = _format(path), bytes_of(samples, channels, recording.data.dtype.name, path.suffix[1:].lower())
        with writing(path, wanted, temporary):
            layout.write(temporary, recording.data, recording.rate, about)
            with temporary.open("rb") as file:
                os.fsync(file.fileno())
            temporary.replace(path)
    except (OSError, ValueError, soundfile.SoundFileError) as fault:
        raise _at(path, fault) from fault
    finally:
        with suppress(OSError):  # of a disk that takes no change at all
            temporary.unlink(missing_ok=True)


def _format(path: Path) -> ModuleType:
    if path.suffix.lower() not in _FORMATS:
        raise RecordingError(f"suffix is {path.suffix!r}, must be one of {', '.join(_FORMATS)}")
    return _FORMATS[path.suffix.lower()]


def _is_plain(text: str) -> bool:
    return isinstance(text, str) and text.strip() == text != "" and text.isprintable() and not set("[]") & set(text)


def _at(path: Path, fault: Exception) -> RecordingError:
    reason = fault.strerror if isinstance(fault, OSError) and fault.strerror else fault
    return RecordingError(f"{path}: {reason}")
