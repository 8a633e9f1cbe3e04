"""The demonstration as a daemon of its own processes."""

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from rigkit.service.access import TOKENS, Tokens, address_of, read_tokens
from rigkit.service.client import Client, DaemonError
from rigkit.service.config import Daemon
from rigkit.service.daemon import EVENTS
from rigkit.service.sockets import Listener
from tests.until import until

ROOT = Path(__file__).parents[3]


@dataclass
class Served:
    """A daemon that answers."""

    settings: Daemon
    process: subprocess.Popen[str]

    @property
    def tokens(self) -> Tokens:
        return read_tokens(Path(self.settings.data) / TOKENS)

    def client(self) -> Client:
        return Client.of(self.settings)

    def events(self) -> list[dict[str, Any]]:
        """Read the event log from the disk, which needs no web process."""
        lines = (Path(self.settings.data) / EVENTS).read_text().splitlines(keepends=True)
        return [json.loads(line) for line in lines if line.endswith("\n")]

    def named(self, event: str) -> list[dict[str, Any]]:
        return [entry for entry in self.events() if entry["event"] == event]

    def newest(self, event: str, field: str) -> Any:
        """Return a field of the newest such event in the file, to which an answer may be ahead; empty without one."""
        return next((entry[field] for entry in reversed(self.named(event))), "")

    @property
    def web(self) -> int:
        """Number of the web process."""
        for pid in children(self.process.pid):
            if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes():
                return pid
        raise AssertionError("there is no web process")

    def begin(self, **options: Any) -> None:
        """Arm and begin a demonstration, as Ada, once one that was stopped before has come to its end."""
        with self.client() as client, client.control("Ada", over=True):
            until(lambda: _is_armed(client))
            client.begin("demonstrate", **options)


def _is_armed(client: Client) -> bool:
    try:
        client.command("arm", "a test")
    except DaemonError as fault:
        if "has not come to its end" not in str(fault):
            raise
        return False
    return True


Started = TypeVar("Started", bound=Served)


def children(pid: int) -> list[int]:
    """Return the processes that a process' main thread has started."""
    return [int(text) for text in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def offspring(pid: int) -> list[int]:
    """Return the processes that any thread of a process has started."""
    threads = Path(f"/proc/{pid}/task").iterdir()
    return [int(text) for thread in threads for text in (thread / "children").read_text().split()]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def answering(made: Started, ready: float = 180, ending: float = 60) -> Iterator[Started]:
    """Wait until a daemon that was started answers, and end it after the block; at most so many seconds each."""
    process = made.process
    try:
        until(lambda: process.poll() is not None or answers(made), ready)
        assert process.poll() is None, process.communicate()[1]
        yield made
    finally:
        process.send_signal(signal.SIGCONT)
        process.terminate()
        process.communicate(timeout=ending)


@contextmanager
def served(
    folder: Path, environment: dict[str, str] | None = None, file: Path | None = None, **settings: Any
) -> Iterator[Served]:
    """Start a daemon on a free port, or as `settings` say, of a rig file, and end it after the block."""
    table = Daemon(data=str(folder), **{"address": f"127.0.0.1:{free_port()}", **settings})
    command = [sys.executable, "-m", "tests.rigkit.service.serve_demo", str(folder), table.model_dump_json()]
    command += [] if file is None else [str(file)]
    process = subprocess.Popen(
        command, cwd=ROOT, stderr=subprocess.PIPE, text=True, env={**os.environ, **(environment or {})}
    )
    with answering(Served(table, process), ending=40) as made:
        yield made


def answers(daemon: Served) -> bool:
    """Whether the page's process is there."""
    path = address_of(daemon.settings.address).path
    try:
        if path:  # httpcore leaves a socket open, and warns, where nobody listens yet
            with socket.socket(socket.AF_UNIX) as probe:
                probe.connect(path)
        with daemon.client() as client:
            return client.snapshot() is not None
    except (DaemonError, OSError):
        return False


def listener() -> Listener:
    """Return a datagram socket on a free port of this machine."""
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind(("127.0.0.1", 0))
    made.settimeout(20)
    return made


def base(daemon: Served) -> str:
    return f"http://{daemon.settings.address}"


def operating(daemon: Served) -> dict[str, str]:
    return {"Authorization": f"Bearer {daemon.tokens.operate}"}
