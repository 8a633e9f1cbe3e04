"""What the host streams to the stage: of which kind, in order, and since when none has come."""

from firmware_sim.reference_queue import ReferenceQueue
from rigkit.wire.layout import Layout
from stagectl.wire import samples
from stagectl.wire.messages import PERIOD, Fault
from stagectl.wire.sequence import Sequence

_FIRST = 0.2
"""s in which the first must come: the host has yet to hear that it may begin."""


class ReferenceStream:
    """Puts what comes into the queue, and says when that is too little.

    Parameters
    ----------
    layout : Layout
        What is expected.
    queue : ReferenceQueue
    silence : float, s without one that is a fault
    """

    def __init__(self, layout: Layout, queue: ReferenceQueue, silence: float) -> None:
        self.layout, self.counter, self.has_come = layout, 0, False
        self.longest_gap = 0.0
        self._queue, self._silence = queue, silence
        self._sequence = Sequence(layout.modulus)
        self._garbled, self._last = 0, 0.0

    def begin(self, layout: Layout, ahead: int, now: float) -> None:
        """Expect another stream from now on, of which `ahead` blocks wait before the first is played."""
        self.layout, self.has_come, self.longest_gap = layout, False, 0.0
        self._sequence = Sequence(layout.modulus)
        self._garbled, self._last = 0, now
        self._queue.clear(ahead)

    def garble(self) -> None:
        """Hear that a frame has come that could not be read."""
        self._garbled += 1

    def take(self, data: bytes, now: float) -> Fault:
        """Take a frame; return the fault that so many lost ones are, or NONE; GarbledError where it is none such."""
        counter, block = samples.decode(self.layout, data)
        missing = self._sequence.accept(counter)
        if missing < 0:
            self._queue.late += 1
            return Fault.NONE
        self.longest_gap = max(self.longest_gap, now - self._last)
        self._last, self._garbled, self.counter = now, 0, counter
        if missing * PERIOD >= self._silence:
            return Fault.REFERENCE_SILENT
        self._queue.put(missing, block)
        self.has_come = True
        return Fault.NONE

    def fault(self, now: float) -> Fault:
        """Return the fault that their absence is, or NONE; the first, before which nothing moves, may take longer."""
        if now - self._last <= (self._silence if self.has_come else max(self._silence, _FIRST)):
            return Fault.NONE
        return Fault.REFERENCE_GARBLED if self._garbled else Fault.REFERENCE_SILENT
