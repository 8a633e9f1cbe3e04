"""The frame that says that all is well: its counter moves on from one to the next, and a checksum guards it."""

from rigkit.wire import dbc
from rigkit.wire.layout import SHORT, Field, Layout

IDENTIFIER = 0x008
"""Before all else that is on a stage's bus."""


def heartbeat(identifier: int = IDENTIFIER, period: float = 0.05) -> Layout:
    """Return the form of the frame.

    Parameters
    ----------
    identifier : int, 11 bits
    period : float, s
    """
    fields = (Field("time", "I", unit="ms"),)
    return Layout("RelayHeartbeat", identifier, "host", SHORT, fields, period, "all is well; time since the first")


def dbc_text() -> str:
    """Return it as a DBC file, with the identifier and period that a rig file has by default."""
    return dbc.dbc_text([heartbeat()], {"host": "relay"})
