"""The table of a rig file that says how a relay is told that all is well."""

from typing import Any

from rigkit.config import Section, code, setting
from rigkit.relay.frame import IDENTIFIER


class Relay(Section):
    """A relay in the amplifier's supply, closed while a heartbeat arrives on its CAN bus."""

    role = "patience"

    bus: str = code(
        "", "module:Class with can.Bus's constructor, such as can:Bus; no frames if empty", r"^([\w.]+:\w+)?$"
    )
    channel: str = setting("can0", "", "the interface's name, or the adapter's port", min_length=1)
    identifier: int = setting(
        IDENTIFIER, "", "of the frame, 11 bits; lower identifiers win the arbitration", ge=0, le=0x7FF
    )
    period: float = setting(
        0.05, "s", "period of the frames; the relay opens after three or more are missing", ge=0.01, le=1
    )
    options: dict[str, Any] = setting({}, "", "more keywords the bus is built with, such as interface and bitrate")
