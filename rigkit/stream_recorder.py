"""What flows by, on the disk as it comes: a block that a graph feeds, and a thread that writes."""

import contextlib
import errno
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from threading import Event, Thread
from typing import Any, Self

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.wav_file import LARGEST_WAV
from rigkit import disk_space
from rigkit.growing_wav import Channels, GrowingWav
from rigkit.provenance import now
from rigkit.ring import Ring

PERIOD = 0.05
"""s between two looks of the writer at what has come."""
SYNCHRONISED = 1.0
"""s between two waits for the disk: what a computer that loses its power may forget."""
RETRY = 2.0
"""s after a fault of the disk until a new file is tried."""
AT_ONCE = 8_192
"""Samples in a write, at most."""

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
    """

    path: Path
    ports: tuple[Port, ...]
    names: tuple[str, ...]
    provenance: Mapping[str, str] = field(default_factory=dict)
    dtype: str = "float64"
    room: float = 10.0
    longest: int = LARGEST_WAV

    def channels(self, rate: float) -> Channels:
        """Return the channels of its files at `rate` samples/s."""
        units = tuple(port.unit for port in self.ports for _ in range(port.width))
        return Channels(self.names, units, rate, self.provenance, self.dtype)


class StreamRecorder(Block):
    """Records its inputs into WAV files that a kill at any moment leaves whole, or to be made whole.

    A context manager: entered after `prepare`, it makes the first file, or raises the OSError that says why not.  What
    flows by before or after that is not recorded.  A disk that is too slow or full never holds up the graph: samples
    for which there is no room are counted in `lost`, the file ends there, and the next begins with the first sample
    that is kept again; `provenance` of each has "first_sample", counted from `prepare`, and "begun", the time (UTC).

    Parameters
    ----------
    stream : Stream
    tell : callable(event, fields)
        Told, by the writer's thread, of "recording_gap", "recording_failed" and "recording_resumed".

    Attributes
    ----------
    files : list of Path, finished or growing
    recorded : int, samples
    fault : str, what is wrong with the disk now, or nothing
    """

    def __init__(self, stream: Stream, tell: Tell) -> None:
        self.inputs = stream.ports
        self.files: list[Path] = []
        self.recorded = 0
        self.fault = ""
        self._stream, self._tell = stream, tell
        self._file: GrowingWav | None = None
        self._thread: Thread | None = None
        self._over = Event()

    def prepare(self, rate: float, frames: int) -> None:
        """Allocate, and count samples from 0; ValueError while it records, or where a WAV cannot hold it."""
        if self._thread is not None:
            raise ValueError(f"{self._stream.path} is being recorded, must be closed before it is prepared again")
        if not 0 < self._stream.longest <= LARGEST_WAV:
            raise ValueError(f"{self._stream.path}: longest is {self._stream.longest} bytes, must be <= {LARGEST_WAV}")
        self._channels = self._stream.channels(rate)
        self._channels.header()
        widths = [port.width for port in self.inputs]
        if len(self._stream.names) != sum(widths):
            raise ValueError(f"{self._stream.path}: {len(self._stream.names)} names, must be {sum(widths)}")
        self._frame = np.zeros((frames, sum(widths)))
        self._tracks = np.split(self._frame, np.cumsum(widths)[:-1], axis=1)
        self._capacity = max(round(self._stream.room * rate), 2 * frames)
        self._ring = Ring(sum(widths), self._capacity)
        self._buffer = np.zeros((min(AT_ONCE, self._capacity), sum(widths)))
        self._restarts: deque[tuple[int, int]] = deque()
        self._seen = self._first = self._overflown = self._refused = 0
        self._is_on, self._is_broken = False, True

    def process(self, *signals: np.ndarray) -> None:
        """Hand one frame to the writer, or count it as lost."""
        first = self._seen
        self._seen += len(self._frame)
        if not self._is_on:
            self._is_broken = True
            return
        room = self._capacity - len(self._ring)
        if room < (self._capacity // 2 if self._is_broken else len(self._frame)):
            self._is_broken = True  # until half is free: not a gap for each frame
            self._overflown += len(self._frame)
            return
        if self._is_broken:
            self._restarts.append((self._ring.written, first))
            self._is_broken = False
        for signal, track in zip(signals, self._tracks, strict=True):
            track[:] = signal
        self._ring.put(self._frame)

    @property
    def lost(self) -> int:
        """Samples that could not be kept while it recorded: the disk was too slow, full or at fault."""
        return self._overflown + self._refused

    def __enter__(self) -> Self:
        """Make the first file and begin."""
        self._first, self._told, self.fault = self._seen, self.lost, ""
        self._retry = self._synchronised = time.monotonic()
        self._begin()
        self._over.clear()
        self._thread = Thread(target=self._work, name=f"record {self._stream.path.name}", daemon=True)
        self._thread.start()
        self._is_on = True
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self.close()

    def close(self) -> None:
        """Write what waits, and finish the file; may be called twice."""
        self._is_on = False
        if self._thread is not None:
            self._over.set()
            self._thread.join()
            self._thread = None

    def _work(self) -> None:
        try:
            while not self._over.wait(PERIOD):
                self._drain()
            self._drain()
            self._tell_lost()
            self._end()
        except Exception as fault:  # a slip of ours: told like a fault of the disk, and not in silence
            self.fault = f"{type(fault).__name__}: {fault}"
            self._say("recording_failed", {"fault": self.fault})
            raise

    def _drain(self) -> None:
        """Write all that has come until now."""
        for _ in range(self._capacity // len(self._buffer) + 2):
            most = len(self._buffer)
            if self._restarts:
                place, first = self._restarts[0]
                most = min(most, place - self._ring.taken)
                if most == 0:
                    self._restarts.popleft()
                    self._restart(first)
                    continue
            count = self._ring.take(self._buffer[:most])
            if not count:
                break
            self._keep(self._buffer[:count])

    def _restart(self, first: int) -> None:
        """Begin anew with sample `first`, unless it follows the last."""
        if first != self._first:
            self._first = first
            self._tell_lost()
            self._end()

    def _keep(self, samples: np.ndarray) -> None:
        """Write, or count as lost while the disk does not take it."""
        try:
            self._write(samples)
            self.recorded += len(samples)
        except OSError as fault:
            self._refused += len(samples)
            self._fail(fault)
        self._first += len(samples)

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
