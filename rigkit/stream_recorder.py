"""What flows by, on the disk as it comes: a block that a graph feeds, and a thread, or whoever ticks, that writes."""

import time
from collections import deque
from pathlib import Path
from threading import Event, Thread
from typing import Self

import numpy as np

from ctlblocks.block import Block
from rigkit.ring import Ring
from rigkit.stream_writer import Stream, StreamWriter, Tell

PERIOD = 0.05
"""s between two looks of the writer at what has come."""
AT_ONCE = 8_192
"""Samples in a write, at most."""


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
        Told, by whoever writes, of "recording_gap", "recording_failed" and "recording_resumed".
    has_thread : bool
        Whether a thread of its own writes; else whoever ticks the graph, who calls `drain_when_due` between ticks.
    """

    def __init__(self, stream: Stream, tell: Tell, *, has_thread: bool = True) -> None:
        self.inputs = stream.ports
        self._stream, self._writer, self._has_thread = stream, StreamWriter(stream, tell), has_thread
        self._thread: Thread | None = None
        self._over, self._is_on = Event(), False
        self._due = 0.0

    def prepare(self, rate: float, frames: int) -> None:
        """Allocate, and count samples from 0; ValueError while it records, or where a WAV cannot hold it."""
        if self._is_on:
            raise ValueError(f"{self._stream.path} is being recorded, must be closed before it is prepared again")
        self._channels = self._stream.channels(rate)
        self._channels.header()
        widths = [port.width for port in self.inputs]
        self._frame = np.zeros((frames, sum(widths)))
        self._tracks = np.split(self._frame, np.cumsum(widths)[:-1], axis=1)
        self._capacity = max(round(self._stream.room * rate), 2 * frames)
        self._ring = Ring(sum(widths), self._capacity)
        self._buffer = np.zeros((min(AT_ONCE, self._capacity), sum(widths)))
        self._restarts: deque[tuple[int, int]] = deque()
        self._seen, self._is_broken = 0, True

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
            self._writer.overflown += len(self._frame)
            return
        if self._is_broken:
            self._restarts.append((self._ring.written, first))
            self._is_broken = False
        for signal, track in zip(signals, self._tracks, strict=True):
            track[:] = signal
        self._ring.put(self._frame)

    @property
    def files(self) -> list[Path]:
        """Files that are finished or growing."""
        return self._writer.files

    @property
    def recorded(self) -> int:
        """Samples on the disk."""
        return self._writer.recorded

    @property
    def lost(self) -> int:
        """Samples that could not be kept while it recorded: the disk was too slow, full or at fault."""
        return self._writer.lost

    @property
    def fault(self) -> str:
        """What is wrong with the disk now; empty for nothing."""
        return self._writer.fault

    def __enter__(self) -> Self:
        """Make the first file and begin."""
        self._writer.open(self._channels, self._seen)
        self._over.clear()
        if self._has_thread:
            self._thread = Thread(target=self._work, name=f"record {self._stream.path.name}", daemon=True)
            self._thread.start()
        self._is_on = True
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self.close()

    def close(self) -> None:
        """Write what waits, and finish the file; may be called twice."""
        was_on, self._is_on = self._is_on, False
        if self._thread is not None:
            self._over.set()
            self._thread.join()
            self._thread = None
        elif was_on:
            self._drain()
            self._writer.close()

    def _work(self) -> None:
        try:
            while not self._over.wait(PERIOD):
                self._drain()
            self._drain()
            self._writer.close()
        except Exception as fault:  # a slip of ours is not silent either
            self._writer.slip(fault)
            raise

    def drain_when_due(self) -> None:
        """Write what has come, where no thread does: each `PERIOD`, and before the memory is half full."""
        moment = time.monotonic()
        if moment >= self._due or len(self._ring) > self._capacity // 4:
            self._due = moment + PERIOD
            self._drain()

    def _drain(self) -> None:
        """Write all that has come until now."""
        for _ in range(self._capacity // len(self._buffer) + 2):
            most = len(self._buffer)
            if self._restarts:
                place, first = self._restarts[0]
                most = min(most, place - self._ring.taken)
                if most == 0:
                    self._restarts.popleft()
                    self._writer.follow_on(first)
                    continue
            count = self._ring.take(self._buffer[:most])
            if not count:
                break
            self._writer.keep(self._buffer[:count])
