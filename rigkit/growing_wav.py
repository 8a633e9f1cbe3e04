"""WAV files that grow: whole after every call, and made whole after a kill in the midst of one."""

import contextlib
import errno
import json
import os
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks.room import DiskFault, writing
from ctlblocks.wav_file import LARGEST_WAV, LONGEST_COMMENT, MARK
from rigkit.atomic import to_disk

GROWING = ".part.wav"
"""Ends the name of a file that is being written, or was when its writer was killed."""
_IEEE_FLOAT = 3
_FORMAT = struct.Struct("<4sI4s4sIHHIIHH4sII")
_LENGTH, _FACT = 4, 44
"""Places of the length of all that follows, and of the number of frames; that of the samples ends the header."""
_LONGEST_HEADER = 100 + LONGEST_COMMENT


@dataclass(frozen=True)
class Channels:
    """What a growing file holds.

    Parameters
    ----------
    names, units : tuple of str, one a channel
    rate : float, samples/s, a whole number
    provenance : mapping of str to str
    dtype : "float32" or "float64"
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    provenance: Mapping[str, str]
    dtype: str = "float64"

    @property
    def frame(self) -> int:
        """Bytes of a sample of all channels."""
        return len(self.names) * np.dtype(self.dtype).itemsize

    def header(self) -> bytes:
        """Return the file before its first sample; ValueError where a WAV cannot hold this."""
        about = {"names": self.names, "units": self.units, "provenance": dict(self.provenance)}
        comment = MARK + json.dumps(about)[1:].encode() + b"\0"
        comment += b"\0" * (len(comment) % 2)
        if len(comment) > LONGEST_COMMENT:
            raise ValueError(f"names, units and provenance take {len(comment)} bytes, must be <= {LONGEST_COMMENT}")
        a_second = self.rate * self.frame
        if not (float(self.rate).is_integer() and 0 < a_second < 2**32) or not 1 <= len(self.names) <= 1024:
            raise ValueError(
                f"{len(self.names)} channels at {self.rate:g} samples/s, must be 1 to 1024 at a whole number of them "
                f"that makes less than 4 GB/s, here {a_second:g}"
            )
        said = len(self.names), int(self.rate), int(a_second), self.frame, 8 * self.frame // len(self.names)
        head = _FORMAT.pack(b"RIFF", 0, b"WAVE", b"fmt ", 16, _IEEE_FLOAT, *said, b"fact", 4, 0)
        listed = struct.pack("<4sI4s4sI", b"LIST", 12 + len(comment), b"INFO", b"ICMT", len(comment)) + comment
        return head + listed + struct.pack("<4sI", b"data", 0)


class GrowingWav:
    """A WAV file to whose end samples are added; a context manager.

    Its header is brought up to date after every `append`, so that any program can read what there is at any moment.
    A process that is killed loses what it has not appended; one whose computer loses its power, what it has not
    `synchronise`d.

    Parameters
    ----------
    path : Path
        Absent; while it grows its name ends in `GROWING`, in place of ".wav".
    channels : Channels

    Raises
    ------
    ValueError : a WAV cannot hold such channels.
    OSError : it cannot be made.
    """

    def __init__(self, path: Path, channels: Channels) -> None:
        header = channels.header()
        self.path, self.channels, self.frames = path, channels, 0
        self._growing = path.with_name(path.stem + GROWING)
        self._start = len(header)
        if path.exists():
            raise FileExistsError(errno.EEXIST, "there is such a file already", str(path))
        with writing(path, len(header), self._growing):
            self._handle = os.open(self._growing, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)
        try:
            with _named(self.path, len(header)):
                self._write(header, 0)
        except OSError:
            os.close(self._handle)
            self._growing.unlink()
            raise

    @property
    def size(self) -> int:
        """Bytes so far."""
        return self._start + self.frames * self.channels.frame

    def append(self, samples: np.ndarray) -> None:
        """Add samples: all of them, or none.

        Parameters
        ----------
        samples : array, shape (samples, channels), in the units of the channels

        Raises
        ------
        ValueError : the file would be longer than a WAV can be.
        OSError : the disk is full, or fails; the file is as it was.
        """
        content = np.ascontiguousarray(samples, np.dtype(self.channels.dtype).newbyteorder("<"))
        if self.size + content.nbytes > LARGEST_WAV:
            raise ValueError(f"{self.path}: more than {LARGEST_WAV} bytes")
        try:
            with _named(self.path, content.nbytes):
                self._write(content.data.cast("B"), self.size)
                _say_lengths(self._handle, self._start, self.frames + len(samples), self.channels.frame)
        except OSError:
            with contextlib.suppress(OSError):
                os.ftruncate(self._handle, self.size)
                _say_lengths(self._handle, self._start, self.frames, self.channels.frame)
            raise
        self.frames += len(samples)

    def synchronise(self) -> None:
        """Wait until it is on the disk; OSError where the disk fails."""
        with _named(self.path):
            os.fsync(self._handle)

    def close(self) -> None:
        """Give it its name; one without a sample is taken away.  May be called twice."""
        if self._handle < 0:
            return
        handle, self._handle = self._handle, -1
        with _named(self.path):
            os.close(handle)
        finish(self._growing)

    def __enter__(self) -> "GrowingWav":
        """Return the file itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()

    def _write(self, content: bytes | memoryview, place: int) -> None:
        done = 0
        while done < len(content):  # a disk that is nearly full takes a part, and then says so
            done += os.pwrite(self._handle, content[done:], place + done)


def finish(growing: Path) -> Path | None:
    """Make a file whole that was growing, and give it its name; where it has no sample, take it away.

    Parameters
    ----------
    growing : Path
        Nobody writes to it any more.

    Returns
    -------
    Path or None
        Its name from now on, with a number more where that is taken.

    Raises
    ------
    OSError : it cannot be written; it is as it was.
    ValueError : its header is damaged; it is as it was.
    """
    size = growing.stat().st_size
    with _named(growing), growing.open("rb+") as file:
        start, frame = _places(growing, file.read(_LONGEST_HEADER))
        frames = (size - start) // frame if start else 0
        if frames:
            file.truncate(start + frames * frame)
            _say_lengths(file.fileno(), start, frames, frame)
            os.fsync(file.fileno())
    if not frames:
        growing.unlink()
        return None
    stem, number = growing.name.removesuffix(GROWING), 0
    whole = growing.with_name(f"{stem}.wav")
    while whole.exists():
        number += 1
        whole = growing.with_name(f"{stem}-again-{number}.wav")
    growing.rename(whole)
    with _named(whole.parent):
        to_disk(whole.parent)
    return whole


def unfinished(folder: Path) -> Iterator[Path]:
    """Find the growing files in `folder` and below, of writers that are at work or were killed."""
    return folder.rglob(f"*{GROWING}")


@contextlib.contextmanager
def _named(path: Path, wanted: int | None = None) -> Iterator[None]:
    """Name the file in an error of the system."""
    try:
        with writing(path, wanted):
            yield
    except DiskFault:
        raise
    except OSError as fault:
        raise OSError(fault.errno, fault.strerror, str(path)) from None


def _say_lengths(handle: int, start: int, frames: int, frame: int) -> None:
    """Say in the header how much there is."""
    content = frames * frame
    os.pwrite(handle, struct.pack("<I", content), start - 4)
    os.pwrite(handle, struct.pack("<I", frames), _FACT)
    os.pwrite(handle, struct.pack("<I", start + content - 8), _LENGTH)


def _places(growing: Path, head: bytes) -> tuple[int, int]:
    """Return where the samples begin, and the bytes of a frame; (0, 1) where the header was cut off."""
    if len(head) < _FORMAT.size:
        return 0, 1
    riff, _, wave, form, *_, frame, _, fact, _, _ = _FORMAT.unpack_from(head)
    start = _FORMAT.size + 16 + int.from_bytes(head[_FORMAT.size + 4 : _FORMAT.size + 8], "little")
    is_cut = len(head) < min(start, _LONGEST_HEADER)
    has_samples = is_cut or head[start - 8 : start - 4] == b"data"
    if (riff, wave, form, fact) != (b"RIFF", b"WAVE", b"fmt ", b"fact") or not (frame and has_samples):
        raise ValueError(f"{growing}: its header is damaged; it is left as it is")
    return (0, 1) if is_cut else (start, frame)
