"""The bus to a relay; the one place here that knows python-can."""

from typing import Any

import can

from rigkit.named_code import named_class
from rigkit.relay.config import Relay

Down = (can.CanError, OSError)
"""What a bus raises when its adapter has gone."""
_AT_A_TIME = 100
"""Frames of others that are passed over at a time."""


class RelayError(OSError):
    """The bus to the relay cannot be opened."""


def named_bus(name: str) -> Any:
    """Return the class of a bus that a rig file names, or `can.Bus`; ConfigError where it is something else."""
    return named_class(name, "the class of a python-can bus", lambda found: issubclass(found, can.BusABC), can.Bus)


class RelayBus:
    """A bus of which only the heartbeat's own frames are of interest.

    Parameters
    ----------
    relay : Relay

    Raises
    ------
    RelayError : it cannot be opened.
    ValueError : there is no such class.
    """

    def __init__(self, relay: Relay) -> None:
        try:
            build = named_bus(relay.bus)
        except ValueError as fault:
            raise ValueError(f"relay.bus, {fault}") from fault
        try:
            self._bus: Any = build(channel=relay.channel, **relay.options)
        except (*Down, ValueError, TypeError, NotImplementedError) as fault:
            raise RelayError(f"{relay.bus} cannot open relay.channel {relay.channel!r}: {fault}") from fault

    def send(self, identifier: int, data: bytes, seconds: float) -> None:
        """Send a frame within `seconds`; raises `Down`."""
        self._bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False), seconds)

    def pass_over(self) -> None:
        """Take in what others have sent, which would fill the adapter up; raises `Down`."""
        for _ in range(_AT_A_TIME):
            try:
                if self._bus.recv(0.0) is None:
                    return
            except ValueError:  # python-can's own slcan, of a line that is no frame
                continue

    def close(self) -> None:
        """Close it; it may have gone already."""
        try:
            self._bus.shutdown()
        except (*Down, TypeError):
            return
