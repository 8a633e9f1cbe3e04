"""What goes to the stage: heartbeats, commands and parameters, and references in blocks."""

from collections import deque

import numpy as np

from rigkit.ring import Ring
from rigkit.wire.layout import Layout
from stagectl.wire import messages, samples
from stagectl.wire.messages import AXES, BLOCK, RATE, Command, HostState

_CAPACITY = RATE // 5
"""Samples of references that may wait: 0.2 s."""


class Outbox:
    """Makes the frames to send.  `ring` is filled by the graph's thread; `frames` is called by the one that sends.

    `references` is how references go, `stream` how what is in the ring does; `sent` counts blocks, `beats` heartbeats.

    Parameters
    ----------
    form : "fd" or "classic"
    """

    def __init__(self, form: str) -> None:
        self.ring = Ring(len(AXES), _CAPACITY)
        self.sent = self.beats = 0
        self.due = 0.0
        classic = form == "classic"
        self.references = messages.SLOW_REFERENCE if classic else messages.REFERENCE
        self.stream = self.references
        self._chunk = messages.SLOW_WRITE_CHUNK if classic else messages.WRITE_CHUNK
        self._waiting: deque[tuple[Layout, tuple[int, ...]]] = deque()
        self._counters: dict[int, int] = {}
        self._block = np.zeros((1 if classic else BLOCK, len(AXES)))

    def command(self, command: Command, token: int, argument: int) -> None:
        """Let a command be sent."""
        self._waiting.append((messages.COMMAND, (command, token, argument)))

    def chunk(self, number: int, data: bytes) -> None:
        """Let a piece of a parameter set be sent."""
        self._waiting.append((self._chunk, (number, *data)))

    def frames(self, state: HostState, now: float, uptime: float) -> list[tuple[int, bytes]]:
        """Return identifier and data of what is to be sent now.

        Raises
        ------
        WireError : a reference is beyond what a frame can carry.
        """
        out = []
        if now >= self.due:
            self.due = max(self.due + messages.HEARTBEAT, now)
            out.append(self._pack(messages.HOST_HEARTBEAT, state, 0, round(1e3 * uptime) % 2**32))
            self.beats += 1
        while self._waiting:
            layout, values = self._waiting.popleft()
            out.append(self._pack(layout, *values))
        if state is not HostState.STREAMING:
            self.ring.skip()
        while len(self.ring) >= len(self._block):
            self.ring.take(self._block)
            out.append((self.stream.identifier, samples.encode(self.stream, self.sent, self._block)))
            self.sent += 1
        return out

    def _pack(self, layout: Layout, *values: int) -> tuple[int, bytes]:
        counter = self._counters.get(layout.identifier, 0)
        self._counters[layout.identifier] = counter + 1
        return layout.identifier, layout.pack(counter, *values)
