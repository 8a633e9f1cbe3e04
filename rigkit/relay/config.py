"""The table of a rig file that says how a relay is told that all is well."""

from typing import Any

from rigkit.config import Section, code, setting
from rigkit.relay.frame import IDENTIFIER


class Relay(Section):
    """A relay in the amplifier's supply, which closes while frames on a CAN bus say that all is well."""

    role = "patience"

    bus: str = code(
        "", "module:Class with can.Bus's constructor, such as can:Bus; no frames if empty", r"^([\w.]+:\w+)?$"
    )
    channel: str = setting("can0", "", "the interface's name, or the adapter's port", min_length=1)
    identifier: int = setting(
        IDENTIFIER, "", "of the frame, 11 bits; the lower goes first on a busy bus", ge=0, le=0x7FF
    )
    period: float = setting(0.05, "s", "from frame to frame; the relay waits for three at least", ge=0.01, le=1)
    options: dict[str, Any] = setting({}, "", "more keywords the bus is built with, such as interface and bitrate")
