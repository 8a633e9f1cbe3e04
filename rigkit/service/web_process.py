"""The process that serves the page and the API: it can stall or die, and the rig does not notice."""

import multiprocessing
from dataclasses import dataclass
from multiprocessing.connection import Connection

from rigkit.code_name import resolve
from rigkit.service.access import Tokens
from rigkit.service.config import Daemon
from rigkit.service.slot import Slot
from rigkit.service.sockets import Listener

SERVER = "rigkit.service.web_server:run"
"""Imported in the child alone: the rig's process needs nothing of a web server."""


@dataclass(frozen=True)
class Wires:
    """What joins the two processes.

    Parameters
    ----------
    slot : Slot
    asking, urgent, notes : Connection
        For questions, for STOP, and for what the web process tells the event log.
    listener : Listener
    """

    slot: Slot
    asking: Connection
    urgent: Connection
    notes: Connection
    listener: Listener


class WebProcess:
    """The child process, on the rig's side.

    Parameters
    ----------
    daemon : Daemon
    tokens : Tokens
    name : str
        Of the program.
    wires : Wires
    """

    def __init__(self, daemon: Daemon, tokens: Tokens, name: str, wires: Wires) -> None:
        context = multiprocessing.get_context("spawn")
        self._process = context.Process(target=_child, args=(daemon, tokens, name, wires), name="web", daemon=True)
        self._process.start()
        for pipe in (wires.asking, wires.urgent, wires.notes):
            pipe.close()  # the child has them now, and their end is its end

    @property
    def pid(self) -> int | None:
        """Number of the process."""
        return self._process.pid

    @property
    def exit_code(self) -> int | None:
        """None while it lives."""
        return self._process.exitcode

    def end(self, seconds: float) -> None:
        """Ask it to end; end it if it does not within `seconds`."""
        self._process.terminate()
        self._process.join(seconds)
        if self._process.exitcode is None:
            self._process.kill()
            self._process.join()


def _child(daemon: Daemon, tokens: Tokens, name: str, wires: Wires) -> None:
    resolve(SERVER)(daemon, tokens, name, wires)
