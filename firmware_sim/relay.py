"""The relay in an amplifier's supply: it closes while the counter of a heartbeat on its CAN bus moves on."""

from collections.abc import Callable
from pathlib import Path
from threading import Event

from firmware_sim.slcan_adapter import SlcanAdapter
from rigkit.relay.frame import heartbeat
from rigkit.wire.layout import GarbledError

_LONGEST_WAIT = 0.01
"""s between two looks at the clock."""


class Relay:
    """What the relay's processor does with each frame; it owns no clock.

    Not modelled: the contact's bounce and the milliseconds that it takes to move.

    Parameters
    ----------
    identifier : int
        Of the frames that count; all others are nothing to it.
    patience : float, s
        For how long it stays closed after a counter that has moved on.
    """

    def __init__(self, identifier: int, patience: float) -> None:
        self._layout, self._patience = heartbeat(identifier), patience
        self._counter: int | None = None
        self._heard = self._moved = -float("inf")
        self.garbled = 0
        """Frames of that identifier which were none."""

    def take(self, identifier: int, data: bytes, now: float) -> None:
        """Take a frame from the bus at the time `now`, s."""
        if identifier != self._layout.identifier:
            return
        try:
            counter, _ = self._layout.unpack(data)
        except GarbledError:
            self.garbled += 1
            return
        if now - self._heard <= self._patience and counter != self._counter:  # else it may be the last one, repeated
            self._moved = now
        self._counter, self._heard = counter, now

    def is_closed(self, now: float) -> bool:
        """Whether the amplifier has power at the time `now`, s."""
        return now - self._moved <= self._patience


def listen(
    adapter: SlcanAdapter, relay: Relay, now: Callable[[], float], tell: Callable[[bool], None], stop: Event
) -> None:
    """Let a relay listen to what a host sends through an adapter until `stop` is set; then pull the adapter out.

    Parameters
    ----------
    adapter : SlcanAdapter
    relay : Relay
    now : callable() -> float, s, a monotonic clock
    tell : callable(bool)
        Told whether it is closed, at first and whenever that changes.
    stop : Event
    """
    told: bool | None = None
    try:
        while not stop.is_set():
            adapter.wait(_LONGEST_WAIT)
            for frame in adapter.received():
                relay.take(frame.identifier, frame.data, now())
            closed = relay.is_closed(now())
            if closed is not told:
                told = closed
                tell(closed)
    finally:
        adapter.unplug()


def adapter_in(folder: Path) -> SlcanAdapter:
    """Return an adapter on a pseudo-terminal whose name is `can`, in a folder that is made if absent."""
    folder.mkdir(parents=True, exist_ok=True)
    return SlcanAdapter(folder / "can")
