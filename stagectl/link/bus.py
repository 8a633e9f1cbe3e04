"""Opens the bus that a rig file names; the one place, beside the bus itself, that knows python-can."""

import os
from typing import Any

import can

from rigkit.machine_lock import MachineLock
from rigkit.relay.bus import named_bus
from stagectl.link.config import Link

LinkDown = (can.CanError, OSError)
"""What a bus raises when its adapter has gone."""
_CLOCK = 80_000_000
_SAMPLE_POINT = 80.0
"""Hz of the controller's clock, and % of a bit at which it is sampled; `link.options` may hold another `timing`."""
_WITHOUT_BITS = ("virtual", "udp_multicast")


class LinkError(OSError):
    """The adapter or the stage is not there, or does not do as it should."""


def open_bus(link: Link) -> can.BusABC:
    """Open the bus.

    Parameters
    ----------
    link : Link

    Raises
    ------
    LinkError : it cannot be opened.
    ValueError : there is no such class.
    """
    try:
        build = named_bus(link.bus)
    except ValueError as fault:
        raise ValueError(f"link.bus, {fault}") from fault
    try:
        bus = build(channel=link.channel, **(_bits(link) | link.options))
    except (*LinkDown, ValueError, TypeError, NotImplementedError) as fault:
        raise LinkError(
            f"{link.bus} cannot open link.channel {link.channel!r} as {link.form}, {link.bitrate} bit/s"
            f"{f' and {link.data_bitrate} bit/s' if link.form == 'fd' else ''}: {fault}"
        ) from fault
    assert isinstance(bus, can.BusABC)
    return bus


def bus_lock(link: Link) -> MachineLock | None:
    """Take the stage's bus, from whoever else would speak on it; None of one that is within programs alone.

    Raises
    ------
    LinkError : another process has it.
    """
    interface = link.options.get("interface", "slcan")
    if interface in _WITHOUT_BITS:
        return None
    is_file = "/" in link.channel
    try:
        return MachineLock(f"the stage's bus {os.path.realpath(link.channel) if is_file else link.channel}")
    except OSError as fault:
        raise LinkError(str(fault)) from None


def message(identifier: int, data: bytes) -> can.Message:
    """Return a frame for the bus; one of more than 8 bytes is CAN FD with the faster data phase."""
    is_fd = len(data) > 8
    return can.Message(arbitration_id=identifier, data=data, is_extended_id=False, is_fd=is_fd, bitrate_switch=is_fd)


def _bits(link: Link) -> dict[str, Any]:
    interface = link.options.get("interface", "slcan")
    if interface in _WITHOUT_BITS:
        return {}
    if (
        interface == "socketcan"
    ):  # its bit rates are the system's: ip link set can0 type can bitrate ... dbitrate ... fd on
        return {"fd": link.form == "fd"}
    quick = {"sleep_after_open": 0} if interface == "slcan" else {}
    if link.form == "classic":
        return {"bitrate": link.bitrate, **quick}
    timing = can.BitTimingFd.from_sample_point(
        f_clock=_CLOCK,
        nom_bitrate=link.bitrate,
        nom_sample_point=_SAMPLE_POINT,
        data_bitrate=link.data_bitrate,
        data_sample_point=_SAMPLE_POINT,
    )
    return {"timing": timing, **quick}
