"""Gauges as JSON over UDP, for PlotJuggler's "UDP Server"."""

import asyncio
import json
from datetime import datetime
from typing import Any

from rigkit.service.access import address_of
from rigkit.service.slot import Slot
from rigkit.service.snapshot import as_bytes
from rigkit.service.stream import LOOK


async def send_gauges(slot: Slot, where: str) -> None:
    """Send each new snapshot's numbers to `where`, "host:port", for ever; nobody needs to listen."""
    address = address_of(where)
    loop = asyncio.get_running_loop()
    transport, _ = await loop.create_datagram_endpoint(
        asyncio.DatagramProtocol, remote_addr=(address.host, address.port)
    )
    seen = 0
    try:
        while True:
            if slot.count != seen and (content := slot.get()) is not None:
                seen = slot.count
                transport.sendto(message(json.loads(content)))
            await asyncio.sleep(LOOK)
    finally:
        transport.close()


def message(snapshot: dict[str, Any]) -> bytes:
    """Return the datagram of a snapshot: a time stamp, and every gauge under the program's name.

    Examples
    --------
    >>> shown = {"tick": 50, "time": "1970-01-01T00:00:02+00:00", "program": "vibractl", "procedure": None}
    >>> message({**shown, "gauges": [{"name": "xruns", "value": 0}]})
    b'{"timestamp": 2.0, "vibractl": {"xruns": 0, "done": 0}}'
    """
    time = datetime.fromisoformat(snapshot["time"]).timestamp()
    values = {gauge["name"]: gauge["value"] for gauge in snapshot["gauges"] if gauge["value"] is not None}
    done = snapshot["procedure"]["done"] if snapshot["procedure"] else 0
    return as_bytes({"timestamp": time, snapshot["program"]: {**values, "done": done}})
