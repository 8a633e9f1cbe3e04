"""The memory that the audio callback shares with the program, across processes: signals, words and one text."""

import ctypes
import enum
import multiprocessing
from typing import Any

import numpy as np

_TEXT = 4096


class Word(enum.IntEnum):
    """Whole numbers in shared memory.  One side writes each."""

    # the program writes
    REQUEST = 0
    """Number of the emission that is wanted; it is under way until DONE is the same."""
    DRIVE = 1
    """Samples of `drive` to play."""
    TIMING = 2
    """Samples of `timing` to play."""
    FRAMES = 3
    """Samples to record."""
    STOP = 4
    """Number of the emission to ramp down and end."""
    CLEAR = 5
    """Times that a person, named in the text, has cleared the guard."""
    END = 6
    """1: ramp down and close the stream."""
    SIGN = 17
    """Moves on while the program waits for an emission: it is alive."""
    PATIENCE = 18
    """ns that the callback goes on playing without a sign; 0 for ever."""
    # the callback writes
    DONE = 7
    """Number of the last emission that has ended."""
    STOPPED = 8
    """1: that emission was ended before its time."""
    CALLBACKS = 9
    """Callbacks so far."""
    INPUT_XRUNS = 10
    """Callbacks of this emission with a flag for lost input."""
    OUTPUT_XRUNS = 11
    """Callbacks of this emission with a flag for lost output."""
    LATE = 12
    """Callbacks of this emission that began more than two blocks after the one before."""
    LATCHED = 13
    """1: the guard is shut by a violation."""
    CLEARED = 14
    """Times that the guard has been cleared."""
    MUTED = 19
    """1: that emission was ended since the program gave no sign."""
    POSITION = 20
    """Samples of this emission that have been recorded."""
    # the process that has the stream writes, or its callback
    BEATS = 21
    """Heartbeats that the relay's bus has taken."""
    FAULT = 15
    """1: the stream is of no more use, the text says why."""
    READY = 16
    """1: the stream runs."""
    STAGE = 22
    """How far the process is on its way there: of `audio_process.STAGES`."""


class Memory:
    """Shared arrays, filled with zeros; pickled to a child process it is the same memory there.

    Parameters
    ----------
    drives, responses : int, channels
    capacity : int, samples
    hydrophones : int, channels
    """

    def __init__(self, drives: int, responses: int, capacity: int, hydrophones: int = 0) -> None:
        size = 8 * len(Word) + _TEXT + 8 * 5 + capacity * (8 * drives + 4 * (drives + responses + hydrophones + 2))
        raw = multiprocessing.get_context("spawn").RawArray(ctypes.c_byte, size)
        self._attach(raw, drives, responses, capacity, hydrophones)

    def _attach(self, raw: Any, drives: int, responses: int, capacity: int, hydrophones: int) -> None:
        self._parts = raw, drives, responses, capacity, hydrophones
        self.capacity = capacity
        self._free = 0
        self.words = self._array(np.int64, len(Word))
        self.latch = self._array(np.float64, 5)
        self.drive = self._array(np.float64, capacity, drives)
        self.timing = self._array(np.float32, capacity)
        self.emitted = self._array(np.float32, capacity, drives)
        self.response = self._array(np.float32, capacity, responses)
        self.far_field = self._array(np.float32, capacity, hydrophones)
        self.loopback = self._array(np.float32, capacity)
        self._text = self._array(np.uint8, _TEXT)

    def _array(self, dtype: type[np.generic], *shape: int) -> np.ndarray:
        count = int(np.prod(shape))
        array = np.frombuffer(self._parts[0], dtype, count, self._free).reshape(shape)
        self._free += array.nbytes
        return array

    def __getstate__(self) -> tuple[Any, int, int, int, int]:
        """Hand over the memory itself, not its content."""
        return self._parts

    def __setstate__(self, parts: tuple[Any, int, int, int, int]) -> None:
        """Attach to the memory of another process."""
        self._attach(*parts)

    @property
    def text(self) -> str:
        """A name or a message."""
        return bytes(self._text).rstrip(b"\0").decode(errors="replace")

    @text.setter
    def text(self, text: str) -> None:
        encoded = text.encode()[:_TEXT]
        self._text[: len(encoded)] = np.frombuffer(encoded, np.uint8)
        self._text[len(encoded) :] = 0
