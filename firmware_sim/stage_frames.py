"""The frames that the stage sends: blocks of samples, heartbeats, its status, and answers."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from firmware_sim.slcan_adapter import Frame
from rigkit.wire.layout import Layout
from stagectl.wire import messages, samples
from stagectl.wire.messages import Fault, State

Signals = Mapping[str, Any]

_FD = (messages.POSITION, messages.EXTENSION, messages.VOLTAGE)
_CLASSIC = (messages.SLOW_POSITION, messages.SLOW_EXTENSION, messages.SLOW_VOLTAGE)


class StageFrames:
    """Collects frames until they are taken; while it `shows_all`, extension and voltage of every block.

    Parameters
    ----------
    form : "fd" or "classic"
    others_every : int, blocks from one extension and voltage to the next; 0 for none
    now : float, s, when the stage is switched on
    """

    def __init__(self, form: str, others_every: int, now: float) -> None:
        self.is_mute = False
        self.shows_all = False
        self.beat_due = now
        self._is_classic, self._every, self._on = form == "classic", others_every, now
        self._report_due = now
        self._counters: dict[int, int] = {}
        self._out: list[Frame] = []

    def take(self) -> list[Frame]:
        """Return what has been collected."""
        out, self._out = self._out, []
        return out

    def send(self, layout: Layout, *values: int) -> None:
        """Add a frame with the next counter of its kind."""
        counter = self._counters.get(layout.identifier, 0)
        self._counters[layout.identifier] = counter + 1
        self._out.append(Frame(layout.identifier, layout.pack(counter, *values), layout.is_fd))

    def publish(self, number: int, signals: Signals) -> None:
        """Add a block's samples, `number` being its counter; WireError where one is out of range.

        What lasers see goes before the positions of its block, and not at all while an axis is excited.
        """
        if "absolute" in signals and not self.shows_all:
            layout = messages.SLOW_ABSOLUTE if self._is_classic else messages.ABSOLUTE
            self._add(layout, number, signals["absolute"])
            if "laser" in signals:
                self.send(messages.LASER_STATUS, *signals["laser"])
        layouts = _CLASSIC if self._is_classic else _FD
        whole = self.shows_all or (self._every and number % self._every == 0)
        names = ("position", "extension", "voltage") if whole else ("position",)
        for name, layout in zip(names, layouts, strict=False):
            self._add(layout, number, signals[name])

    def _add(self, layout: Layout, number: int, block: np.ndarray) -> None:
        shown = block[-1:] if self._is_classic else block
        self._out.append(Frame(layout.identifier, samples.encode(layout, number, shown), layout.is_fd))

    def send_back(self, pieces: list[tuple[int, bytes]]) -> None:
        """Add pieces of a parameter set."""
        for number, data in pieces:
            self.send(messages.SLOW_READ_CHUNK if self._is_classic else messages.READ_CHUNK, number, *data)

    def beat(self, now: float, state: State, fault: Fault, account: Callable[[], tuple[int, ...]]) -> None:
        """Add the heartbeat and the status that are due; `account` gives the status' fields between time and state."""
        uptime = now - self._on
        if now >= self.beat_due:
            self.beat_due = max(self.beat_due + messages.HEARTBEAT, now)
            if not self.is_mute:
                self.send(messages.STAGE_HEARTBEAT, state, fault, round(1e3 * uptime) % 2**32)
        if now >= self._report_due and not self._is_classic:
            self._report_due = max(self._report_due + messages.STATUS.period, now)
            self.send(messages.STATUS, round(1e9 * uptime), *account(), state, fault)
