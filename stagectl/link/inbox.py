"""What comes from the stage: samples in order, its state, and what was lost, late or garbled on the way."""

from collections import deque

import numpy as np

from rigkit.ring import Ring
from rigkit.wire.layout import GarbledError, Layout
from stagectl.link.account import Counts, Status
from stagectl.link.capture import Capture
from stagectl.wire import messages, samples
from stagectl.wire.messages import AXES, RATE, Fault, State
from stagectl.wire.sequence import Sequence

SIGNALS = {
    "position": {"fd": messages.POSITION, "classic": messages.SLOW_POSITION},
    "extension": {"fd": messages.EXTENSION, "classic": messages.SLOW_EXTENSION},
    "voltage": {"fd": messages.VOLTAGE, "classic": messages.SLOW_VOLTAGE},
}
_ABSOLUTE = {"fd": messages.ABSOLUTE, "classic": messages.SLOW_ABSOLUTE}
_STREAMS = {layout.identifier for layouts in (*SIGNALS.values(), _ABSOLUTE) for layout in layouts.values()}
_CAPACITY = 2 * RATE
"""Samples kept for a graph that stands still: 2 s."""


class Inbox:
    """Sorts the frames from the stage.  Fed by one thread, read by others.

    Parameters
    ----------
    form : "fd" or "classic"
    """

    def __init__(self, form: str) -> None:
        self.counts = Counts()
        self.state, self.fault = State.HOLDING, Fault.NONE
        self.heard = -np.inf
        self.status: Status | None = None
        self.capture: Capture | None = None
        self.replies: deque[tuple[int, int, int]] = deque(maxlen=16)
        self.chunks: dict[int, bytes] = {}
        self.rings = {name: Ring(len(AXES), _CAPACITY) for name in (*SIGNALS, "absolute")}
        self.newest = {name: np.full(len(AXES), np.nan) for name in (*SIGNALS, "absolute")}
        self._absolute = _ABSOLUTE[form]
        self._seen: tuple[int, np.ndarray] | None = None
        self._names = {layouts[form].identifier: name for name, layouts in SIGNALS.items()}
        self._stream = SIGNALS["position"][form]
        self._sequence = Sequence(self._stream.modulus)

    def take(self, identifier: int, data: bytes, now: float) -> None:
        """Take one frame; one that is not the stage's is passed over."""
        layout = messages.BY_IDENTIFIER.get(identifier)
        if layout is None or layout.sender != "stage":
            return
        try:
            if identifier in self._names:
                self._samples(layout, data)
            elif layout is self._absolute:
                self._seen = samples.decode(layout, data)
            elif identifier not in _STREAMS:
                self._record(layout, layout.unpack(data)[1], now)
        except GarbledError:
            self.counts.garbled += 1
            return
        self.counts.received += 1

    def rejoin(self) -> None:
        """Take the next block as the first: the link was down, and what was missed is not made up."""
        self._sequence.reset()

    def _samples(self, layout: Layout, data: bytes) -> None:
        counter, block = samples.decode(layout, data)
        name = self._names[layout.identifier]
        if (capture := self.capture) is not None:
            capture.take(name, counter, block)
        if layout is self._stream:
            missing = self._sequence.accept(counter)
            if missing < 0:
                self.counts.late += 1
                return
            if missing:
                self._fill(missing)
            self._put_absolute(counter, len(block))
        self.rings[name].put(block)
        self.newest[name][:] = block[-1]

    def _put_absolute(self, counter: int, count: int) -> None:
        """Put what lasers saw beside the positions of its block; what was lost, or is not read, is held."""
        seen, self._seen = self._seen, None
        if seen is not None and seen[0] == counter:
            self.newest["absolute"][:] = seen[1][-1]
            self.rings["absolute"].put(seen[1])
            return
        self.counts.lasers.lost += 1
        self.rings["absolute"].put(np.tile(self.newest["absolute"], (count, 1)))

    def _fill(self, missing: int) -> None:
        """Hold the last sample in the place of lost blocks, so that those after them keep their time."""
        self.counts.lost += missing
        self.counts.longest_gap = max(self.counts.longest_gap, missing)
        count = missing * len(self._stream.fields) // len(AXES)
        for name in ("position", "absolute"):
            self.rings[name].put(np.tile(self.newest[name], (min(count, _CAPACITY), 1)))

    def _record(self, layout: Layout, values: tuple[int, ...], now: float) -> None:
        if layout is messages.STAGE_HEARTBEAT:
            self.state, self.fault, self.heard = State(values[0]), Fault(values[1]), now
        elif layout is messages.STATUS:
            time, block, parameters, lost, late, garbled, underruns, reference, waiting, silence, *_ = values
            counts = lost, late, garbled, underruns
            self.status = Status(1e-9 * time, block, parameters, *counts, reference, waiting, 1e-4 * silence)
            if (capture := self.capture) is not None:
                capture.report(self.status)
        elif layout is messages.LASER_STATUS:
            self.counts.lasers.take(1e-4 * values[0], values[1], values[2])
        elif layout is messages.REPLY:
            self.replies.append((values[0], values[1], values[2]))
        else:
            self.chunks[values[0]] = bytes(values[1:])
