"""A simulated card's block exchange: latency, buffers and faults between a callback and the laboratory."""

import time
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from firmware_sim.faults import BadSample, Drop, Fault, Slip, Stall
from firmware_sim.laboratory import Laboratory

CONVERTER_DELAY = 61
"""Samples in both converters' filters; with the block size it makes the round trip."""


class CallbackFlags:
    """What went wrong since the callback before, under sounddevice's names."""

    input_underflow = False
    output_overflow = False
    priming_output = False

    def __init__(self, lost: bool) -> None:
        self.input_overflow = self.output_underflow = lost

    def __bool__(self) -> bool:
        """Whether any flag is set."""
        return self.input_overflow


class StreamTime(NamedTuple):
    """Times of a block on the stream's clock, s, under PortAudio's names."""

    inputBufferAdcTime: float  # noqa: N815
    currentTime: float  # noqa: N815
    outputBufferDacTime: float  # noqa: N815


class Card:
    """Exchange blocks with a callback; the round trip is `blocksize + CONVERTER_DELAY` samples.

    The output buffer is handed over as the callback left it a block ago, as drivers do.

    Parameters
    ----------
    laboratory : Laboratory
    rate : float, samples/s
    blocksize : int, samples
    channels : (int, int), inputs and outputs
    faults : iterable of Fault
    """

    def __init__(
        self, laboratory: Laboratory, rate: float, blocksize: int, channels: tuple[int, int], faults: Iterable[Fault]
    ) -> None:
        inputs, outputs = channels
        self.blocks = 0
        self.faults = list(faults)
        self._laboratory, self._rate, self._blocksize = laboratory, rate, blocksize
        self._played = np.zeros((blocksize, outputs), np.float32)
        self._recorded = np.zeros((blocksize, inputs), np.float32)
        self._heard = np.zeros((blocksize, inputs), np.float32)
        self._on_the_way = np.zeros((blocksize + CONVERTER_DELAY, inputs), np.float32)
        self._lost = False
        laboratory.prepare(rate, blocksize)

    @property
    def time(self) -> float:
        """The stream's clock, s: blocks exchanged."""
        return self.blocks * self._blocksize / self._rate

    def exchange(self, callback: Callable[..., None]) -> None:
        """Record a block, call back, play a block.  What the callback raises comes through; nothing is played then."""
        due = [fault for fault in self.faults if fault.block == self.blocks]
        self.blocks += 1
        self._receive()
        for fault in due:
            self._spoil(fault)
        if any(isinstance(fault, Drop) for fault in due):
            self._played.fill(0.0)
        else:
            self._call(callback)
        self._laboratory.step(self._played, self._recorded)
        self._on_the_way[-self._blocksize :] = self._recorded

    def _receive(self) -> None:
        self._heard[:] = self._on_the_way[: self._blocksize]
        self._on_the_way[: -self._blocksize] = self._on_the_way[self._blocksize :]

    def _call(self, callback: Callable[..., None]) -> None:
        flags, self._lost = CallbackFlags(self._lost), False
        latency = len(self._on_the_way) / self._rate
        callback(
            self._heard, self._played, self._blocksize, StreamTime(self.time - latency, self.time, self.time), flags
        )

    def _spoil(self, fault: Fault) -> None:
        match fault:
            case Drop(flagged=flagged):
                self._lost = flagged
            case Slip(samples=samples):
                self._slip(samples)
            case BadSample(channel=channel, value=value):
                self._heard[self._blocksize // 2, channel - 1] = value
            case Stall(seconds=seconds):
                time.sleep(seconds)

    def _slip(self, samples: int) -> None:
        latency = len(self._on_the_way) + samples
        if latency < self._blocksize:
            raise ValueError(f"a slip by {samples} samples: must be >= {self._blocksize - len(self._on_the_way)}")
        later = np.zeros((latency, self._on_the_way.shape[1]), np.float32)
        kept = len(self._on_the_way) - max(-samples, 0)
        later[latency - kept :] = self._on_the_way[-kept:]
        self._on_the_way = later
