"""A simulated relay that listens on python-can's virtual bus, or behind an adapter on a pseudo-terminal."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import can

from firmware_sim.relay import Relay, adapter_in, listen
from rigkit.relay.frame import IDENTIFIER
from tests.until import until

PATIENCE = 0.5
"""s; a busy test machine may need some of it."""


class Heard:
    """What a relay has done."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self.relay = Relay(IDENTIFIER, patience)
        self.moves: list[bool] = []

    def until(self, closed: bool) -> None:
        """Return when it is closed, or open."""
        until(lambda: self.relay.is_closed(time.monotonic()) is closed)


def virtual(channel: str) -> dict[str, Any]:
    """Return the settings of a relay on the virtual bus of this process."""
    return {"bus": "can:Bus", "channel": channel, "options": {"interface": "virtual"}, "period": 0.03}


def on_a_port(folder: Path) -> dict[str, Any]:
    """Return the settings of a relay behind an adapter on a pseudo-terminal."""
    return {"bus": "stagectl.link.slcan:SlcanBus", "channel": str(folder / "can"), "options": {"bitrate": 500_000}}


@contextmanager
def on_the_virtual_bus(channel: str) -> Iterator[Heard]:
    """Let a relay listen on the virtual bus of this process."""
    heard = Heard()
    with can.Bus(interface="virtual", channel=channel) as bus:

        def take(message: can.Message) -> None:
            heard.relay.take(message.arbitration_id, bytes(message.data), time.monotonic())

        notifier = can.Notifier(bus, [take], timeout=0.05)
        try:
            yield heard
        finally:
            notifier.stop()


class Plug:
    """A relay that listens behind an adapter, `can` in a folder; it is plugged in at first.

    The adapter belongs to the thread that listens, so what is plugged in is another one each time.
    """

    def __init__(self, folder: Path, heard: Heard) -> None:
        self._folder, self._heard = folder, heard
        self.plug()

    def plug(self) -> None:
        """Plug an adapter in."""
        self._stop = threading.Event()
        arguments = (adapter_in(self._folder), self._heard.relay, time.monotonic, self._heard.moves.append, self._stop)
        self._thread = threading.Thread(target=listen, args=arguments)
        self._thread.start()

    def unplug(self) -> None:
        """Return when it is pulled out."""
        self._stop.set()
        self._thread.join()


@contextmanager
def behind_an_adapter(folder: Path, patience: float = PATIENCE) -> Iterator[tuple[Heard, Plug]]:
    """Let a relay listen behind an adapter, `can` in a folder."""
    heard = Heard(patience)
    plug = Plug(folder, heard)
    try:
        yield heard, plug
    finally:
        plug.unplug()
