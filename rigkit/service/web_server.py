"""What runs in the web process: uvicorn, the gate, the API, and what follows the snapshots."""

import asyncio
import gc
import multiprocessing
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Any

import uvicorn

from rigkit.posix import resource
from rigkit.service.access import Tokens, names, origins
from rigkit.service.config import Daemon
from rigkit.service.connections import PatientProtocol, Waiting
from rigkit.service.gate import Gate, Rules
from rigkit.service.link import Asking, NoAnswer
from rigkit.service.metrics import Metrics
from rigkit.service.plotjuggler import send_gauges
from rigkit.service.stream import Audience
from rigkit.service.web import Ends, application
from rigkit.service.web_process import Wires

ANSWER_WITHIN = 10.0
"""s that the rig's process may take for an answer: it may be computing between two shots."""
LARGEST_MESSAGE = 1024
"""Bytes of a WebSocket message from a client: it says which tick it has read."""
HANDSHAKE_WITHIN = 5.0
"""s for the handshake of TLS."""
OPEN_FILES = 8_192
"""Connections and files at a time, where the system allows as many: far more than are ever kept."""
_NOTES_WAITING = 100


class _Server(uvicorn.Server):
    """Leaves signals to the rig's process, which decides when this one ends."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def run(daemon: Daemon, tokens: Tokens, name: str, wires: Wires) -> None:
    """Serve until SIGTERM, or until the rig's process is gone: the child's whole life."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    asking, urgent = (Asking(pipe, ANSWER_WITHIN) for pipe in (wires.asking, wires.urgent))
    notes = Asking(wires.notes, ANSWER_WITHIN)
    refusals = [0]

    def tell(event: str, fields: Mapping[str, Any]) -> None:
        refusals[0] += 1
        if threading.active_count() < _NOTES_WAITING:
            threading.Thread(target=_note, args=(notes, event, fields), daemon=True).start()

    audience = Audience(wires.slot, daemon.clients, lambda place, why: tell("dropped", {"address": place, "why": why}))
    metrics = Metrics(
        wires.slot,
        lambda: (
            ("clients", "clients of the stream that came", audience.came),
            ("clients_gone", "of those, gone again", audience.came - audience.size),
            ("stream_snapshots", "snapshots sent to clients", audience.sent),
            ("stalled_clients", "clients closed since they did not read", audience.stalled),
            ("refusals", "requests refused and clients closed", refusals[0]),
        ),
    )
    data = Path(daemon.data)
    ends = Ends(wires.slot, asking, urgent, data / "runs", Path(str(files("rigkit.service"))) / "page")
    rules = Rules(names(daemon), origins(daemon), tokens, daemon.requests, _is_open, lambda told: tell("refused", told))
    app = Gate(application(ends, audience, metrics, name), rules)
    protocol = PatientProtocol.bound(Waiting(app.tell))
    server = _Server(_settings(app, daemon, protocol))
    _allow_files()
    gc.collect()
    gc.freeze()  # all that stays; else requests' cycles would lie about until they were a quarter of it
    with asyncio.Runner(loop_factory=_Loop) as runner:
        runner.run(_serve(server, wires, daemon))


class _Loop(asyncio.SelectorEventLoop):
    """An event loop that waits for a handshake no longer than for a request."""

    async def create_server(self, *given: Any, **options: Any) -> asyncio.Server:
        if options.get("ssl"):
            options["ssl_handshake_timeout"] = HANDSHAKE_WITHIN
        return await super().create_server(*given, **options)


def _allow_files() -> None:
    if resource is None:
        return
    allowed, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OPEN_FILES if most == resource.RLIM_INFINITY else min(OPEN_FILES, most)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(allowed, wanted), most))


async def _serve(server: _Server, wires: Wires, daemon: Daemon) -> None:
    def end() -> None:
        server.should_exit = True

    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGTERM, end)
    parent = multiprocessing.parent_process()
    if parent is not None:
        loop.add_reader(parent.sentinel, end)
    sending = asyncio.create_task(send_gauges(wires.slot, daemon.plotjuggler)) if daemon.plotjuggler else None
    await server.serve(sockets=[wires.listener])
    if sending is not None:
        sending.cancel()


def _settings(app: Gate, daemon: Daemon, protocol: type[PatientProtocol]) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        http=protocol,
        ws="websockets-sansio",
        ws_max_size=LARGEST_MESSAGE,
        ws_per_message_deflate=False,
        timeout_keep_alive=5,
        timeout_graceful_shutdown=1,
        h11_max_incomplete_event_size=16_384,
        ssl_certfile=daemon.certificate or None,
        ssl_keyfile=daemon.key or None,
        server_header=False,
        access_log=False,
        log_level="warning",
        proxy_headers=False,
    )


def _is_open(path: str) -> bool:
    """Whether a path needs no token: the page itself and the description of the API hold nothing of the rig."""
    return not path.startswith(("/api/", "/metrics"))


def _note(notes: Asking, event: str, fields: Mapping[str, Any]) -> None:
    try:
        notes.ask({"do": "note", "with": {"event": event, "who": "web", "fields": dict(fields)}})
    except NoAnswer:
        return
