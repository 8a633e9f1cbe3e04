"""The stage's processor behind a CAN FD adapter: the loop that serves both, and what can be made to go wrong."""

import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Event

from firmware_sim.slcan_adapter import SlcanAdapter
from firmware_sim.stage_lasers import MISHAPS as LASERS
from firmware_sim.stage_processor import StageProcessor

NOISE = bytes(range(1, 256)) + b"b101F00FF\rt0118zz\r\a"
"""Bytes that come out of a bad cable: none of them ASCII only, broken frames, a bell."""
_LONGEST_WAIT = 0.01


MISHAPS = ("unplug", "replug", "garbage", "no-heartbeat", "heartbeat", "stuck-sensor", *LASERS)


@dataclass(frozen=True)
class Mishap:
    """Something that goes wrong at a time.

    Parameters
    ----------
    name : str, one of `MISHAPS`
    seconds : float, s after the node was started, >= 0
    """

    name: str
    seconds: float

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        if self.name not in MISHAPS or not 0 <= self.seconds < math.inf:
            raise ValueError(f"a mishap is {self.name}@{self.seconds:g}, must be {', '.join(MISHAPS)}, at >= 0 s")


def mishap(text: str) -> Mishap:
    """Read "NAME@SECONDS".

    Examples
    --------
    >>> mishap("unplug@2.5")
    Mishap(name='unplug', seconds=2.5)
    """
    name, _, seconds = text.partition("@")
    try:
        at = float(seconds)
    except ValueError:
        raise ValueError(f"a mishap is {text}, must be NAME@SECONDS, such as unplug@5") from None
    return Mishap(name, at)


class CanNode:
    """Serves an adapter and a processor until it is told to stop.

    Parameters
    ----------
    adapter : SlcanAdapter
    processor : StageProcessor
    sensor : callable(str)
        Lets a sensor of the simulated stage go wrong: "stuck-sensor" or one of `stage_lasers.MISHAPS`.
    mishaps : sequence of Mishap
    now : callable() -> float, s, a monotonic clock; that of the processor
    """

    def __init__(
        self,
        adapter: SlcanAdapter,
        processor: StageProcessor,
        sensor: Callable[[str], None],
        mishaps: Sequence[Mishap] = (),
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.adapter, self.processor = adapter, processor
        self._sensor, self._now = sensor, now
        self._asked: deque[str] = deque()
        self._to_come = sorted(mishaps, key=lambda mishap: mishap.seconds)

    def run(self, stop: Event) -> None:
        """Serve until `stop` is set; then pull the adapter out."""
        start = self._now()
        try:
            while not stop.is_set():
                now = self._now()
                while self._to_come and now - start >= self._to_come[0].seconds:
                    self._asked.append(self._to_come.pop(0).name)
                while self._asked:
                    self._happen(self._asked.popleft())
                self.adapter.wait(min(self.processor.due - now, _LONGEST_WAIT))
                self.serve()
        finally:
            self.adapter.unplug()

    def serve(self) -> None:
        """Take what the host has sent, run what is due, send what that gives."""
        now = self._now()
        for frame in self.adapter.received():
            self.processor.receive(frame, now)
        for frame in self.processor.advance(now):
            self.adapter.send(frame)

    def suffer(self, name: str) -> None:
        """Let a mishap happen, from any thread; it does before the next block."""
        self._asked.append(name)

    def _happen(self, name: str) -> None:
        match name:
            case "unplug":
                self.adapter.unplug()
            case "replug":
                self.adapter.plug()
            case "garbage":
                self.adapter.spill(NOISE)
            case "no-heartbeat" | "heartbeat":
                self.processor.frames.is_mute = name == "no-heartbeat"
            case _:
                self._sensor(name)
