"""A place for the newest of something, shared by two processes: writing never waits, reading never gets a mixture."""

import ctypes
import multiprocessing
from typing import Any

import numpy as np

CAPACITY = 1 << 18
_COUNT, _LENGTH = range(2)


class Slot:
    """Bytes in shared memory of which only the newest are kept.  One process writes, any number read.

    Source
    ------
    A sequence lock: the count is odd while the writer is at work, and has moved on where it has been.
    """

    def __init__(self) -> None:
        self._attach(multiprocessing.get_context("spawn").RawArray(ctypes.c_byte, 16 + CAPACITY))

    def _attach(self, raw: Any) -> None:
        self._raw = raw
        self._words = np.frombuffer(raw, np.int64, 2)
        self._content = memoryview(raw).cast("B")[16:]

    def __getstate__(self) -> Any:
        """Hand over the memory itself, not its content."""
        return self._raw

    def __setstate__(self, raw: Any) -> None:
        """Attach to the memory of another process."""
        self._attach(raw)

    @property
    def count(self) -> int:
        """Moves on with each `put`."""
        return int(self._words[_COUNT])

    def put(self, content: bytes) -> None:
        """Put `content` in the place of what was there.

        Raises
        ------
        ValueError : it is longer than `CAPACITY`.
        """
        if len(content) > CAPACITY:
            raise ValueError(f"{len(content)} bytes, must be <= {CAPACITY}")
        self._words[_COUNT] += 1
        self._content[: len(content)] = content
        self._words[_LENGTH] = len(content)
        self._words[_COUNT] += 1

    def get(self) -> bytes | None:
        """Return the newest, whole; None where there is none yet, or the writer was at work each time one looked."""
        for _ in range(10):
            before = self.count
            content = bytes(self._content[: self._words[_LENGTH]])
            if before and before % 2 == 0 and before == self.count:
                return content
        return None
