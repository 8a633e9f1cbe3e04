"""Samples that come without an end, written into one WAV file after another, whatever the disk does."""

import contextlib
import errno
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks.block import Port
from ctlblocks.wav_file import LARGEST_WAV
from rigkit import disk_space
from rigkit.growing_wav import Channels, GrowingWav
from rigkit.provenance import now

SYNCHRONISED = 1.0
"""s between two waits for the disk: what a computer that loses its power may forget."""
RETRY = 2.0
"""s after a fault of the disk until a new file is tried."""

Tell = Callable[[str, Mapping[str, Any]], object]
"""Takes an event and its fields."""


@dataclass(frozen=True)
class Stream:
    """What is recorded, and where.

    Parameters
    ----------
    path : Path
        Of the first file, ending in .wav; a further one has "-0001" and so on before that.
    ports : tuple of Port
    names : tuple of str
        One a channel.
    provenance : mapping of str to str
    dtype : "float32" or "float64"
    room : float, s, that wait in memory for a slow disk, at most
    longest : int, bytes of a file, at which the next begins

    Raises
    ------
    ValueError : there are not as many names as channels, or `longest` is more than a WAV can be.
    """

    path: Path
    ports: tuple[Port, ...]
    names: tuple[str, ...]
    provenance: Mapping[str, str] = field(default_factory=dict)
    dtype: str = "float64"
    room: float = 10.0
    longest: int = LARGEST_WAV

    def __post_init__(self) -> None:
        """Refuse what cannot be recorded at any rate."""
        width = sum(port.width for port in self.ports)
        if len(self.names) != width:
            raise ValueError(f"{self.path}: {len(self.names)} names, must be {width}")
        if not 0 < self.longest <= LARGEST_WAV:
            raise ValueError(f"{self.path}: longest is {self.longest} bytes, must be <= {LARGEST_WAV}")

    def channels(self, rate: float) -> Channels:
        """Return the channels of its files at `rate` samples/s."""
        units = tuple(port.unit for port in self.ports for _ in range(port.width))
        return Channels(self.names, units, rate, self.provenance, self.dtype)


class StreamWriter:
    """Writes the samples of a stream, and counts those that the disk does not take.

    Parameters
    ----------
    stream : Stream
    tell : callable(event, fields)
        Told of "recording_gap", "recording_failed" and "recording_resumed".

    Attributes
    ----------
    files : list of Path, finished or growing
    recorded : int, samples
    overflown : int, samples that were lost before they came here; counted by whoever lost them
    fault : str, what is wrong with the disk now, or nothing
    """

    def __init__(self, stream: Stream, tell: Tell) -> None:
        self.files: list[Path] = []
        self.recorded = self.overflown = 0
        self.fault = ""
        self._stream, self._tell = stream, tell
        self._refused = self._told = 0
        self._file: GrowingWav | None = None

    @property
    def lost(self) -> int:
        """Samples that could not be kept: the disk was too slow, full or at fault."""
        return self.overflown + self._refused

    def open(self, channels: Channels, first: int) -> None:
        """Make the first file, for samples from number `first` on; OSError says why it cannot be."""
        self._channels, self._first, self.fault = channels, first, ""
        self._retry = self._synchronised = time.monotonic()
        self._begin()

    def follow_on(self, first: int) -> None:
        """Go on with sample number `first`, in a new file unless it follows the last."""
        if first != self._first:
            self._first = first
            self._tell_lost()
            self._end()

    def keep(self, samples: np.ndarray) -> None:
        """Write samples, or count them as lost while the disk does not take them.

        Parameters
        ----------
        samples : array, shape (samples, channels), in the units of the ports
        """
        try:
            self._write(samples)
            self.recorded += len(samples)
        except OSError as fault:
            self._refused += len(samples)
            self._fail(fault)
        self._first += len(samples)

    def close(self) -> None:
        """Finish the file."""
        self._tell_lost()
        self._end()

    def slip(self, fault: Exception) -> None:
        """Tell a fault of the program like one of the disk."""
        self.fault = f"{type(fault).__name__}: {fault}"
        self._say("recording_failed", {"fault": self.fault})

    def _write(self, samples: np.ndarray) -> None:
        moment = time.monotonic()
        if self._file is not None and self._file.size + len(samples) * self._channels.frame > self._stream.longest:
            self._end()
        if self._file is None and moment < self._retry:
            raise OSError(errno.EAGAIN, self.fault)
        file = self._file or self._begin()
        if moment - self._synchronised > SYNCHRONISED:
            self._synchronised = moment
            disk_space.refuse_full(self._stream.path.parent)
            file.synchronise()
        file.append(samples)
        if self.fault:
            self.fault, self._told = "", self.lost
            self._say("recording_resumed", {"lost": self.lost})

    def _begin(self) -> GrowingWav:
        """Make the next file."""
        path = self._stream.path
        disk_space.refuse_full(path.parent)
        if self.files:
            path = path.with_name(f"{path.stem}-{len(self.files):04d}.wav")
        about = {**self._channels.provenance, "first_sample": str(self._first), "begun": now()}
        self._file = GrowingWav(path, replace(self._channels, provenance=about))
        self.files.append(path)
        return self._file

    def _end(self) -> None:
        """Finish the file."""
        file, self._file = self._file, None
        if file is None:
            return
        if not file.frames:
            self.files.remove(file.path)
        try:
            file.close()
        except OSError as fault:
            self._fail(fault)

    def _fail(self, fault: OSError) -> None:
        """Try again later, with a new file."""
        if not self.fault:
            self.fault = str(fault.strerror)
            self._say("recording_failed", {"fault": self.fault})
        if fault.errno != errno.EAGAIN:
            self._retry = time.monotonic() + RETRY
        self._end()

    def _tell_lost(self) -> None:
        if self.lost > self._told:
            self._told = self.lost
            self._say("recording_gap", {"lost": self.lost})

    def _say(self, event: str, fields: Mapping[str, Any]) -> None:
        with contextlib.suppress(OSError):  # where the same disk is full; `fault` and `lost` say it
            self._tell(event, {"recording": self._stream.path.name, **fields})
