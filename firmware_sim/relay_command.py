"""The command `firmware-sim relay`: the relay of an amplifier's supply behind its wire."""

import time
from pathlib import Path
from tempfile import mkdtemp
from threading import Event
from typing import Annotated

import typer

from firmware_sim.ready import be_ready, say
from firmware_sim.relay import Relay, adapter_in, listen
from rigkit.command import JsonOption
from rigkit.relay.frame import IDENTIFIER
from rigkit.stop import SIGNALS, on_signals


def relay_command(
    pty: Annotated[bool, typer.Option("--pty", help="Use a pseudo-terminal.")] = False,
    folder: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder of the adapter, can.")] = None,
    identifier: Annotated[int, typer.Option(min=0, max=0x7FF, help="Identifier of the heartbeat.")] = IDENTIFIER,
    patience: Annotated[
        float, typer.Option(min=0.03, max=10, metavar="SECONDS", help="Time-out of the heartbeat.")
    ] = 0.2,
    json: JsonOption = None,
) -> None:
    """Put the relay of an amplifier's supply behind a CAN adapter, until Ctrl-C; it says when it closes and opens.

    Example:

        firmware-sim relay --pty --folder /tmp/relay &

        vibractl run --set audio.relay.bus=can:Bus --set audio.relay.options.interface=slcan --set
        audio.relay.channel=/tmp/relay/can ...
    """
    if not pty:
        raise ValueError("no wire is chosen, must be --pty")
    adapter, stop = adapter_in(folder or Path(mkdtemp(prefix="relay-"))), Event()
    start = time.monotonic()

    def tell(closed: bool) -> None:
        say(f"{time.monotonic() - start:8.3f} s: {'closed' if closed else 'open'}", json)

    with on_signals(dict.fromkeys(SIGNALS, stop.set)):
        be_ready(f"CAN adapter: {adapter.path}", {"can": str(adapter.path)}, json)
        listen(adapter, Relay(identifier, patience), time.monotonic, tell, stop)
