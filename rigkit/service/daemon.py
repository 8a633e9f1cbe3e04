"""The rig's process: it owns the rig, shows it 25 times a second, and keeps the web process alive."""

import logging
import multiprocessing
import signal
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Self

from rigkit.lock import Lock
from rigkit.machine_lock import DeviceInUseError, MachineLock
from rigkit.service.access import TOKENS, address_of, refuse_open, tokens_at
from rigkit.service.commands import Commands
from rigkit.service.config import Daemon
from rigkit.service.control import DAEMON, Control
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease
from rigkit.service.link import serve
from rigkit.service.paths import RUNS
from rigkit.service.rig import Rig
from rigkit.service.slot import Slot
from rigkit.service.snapshot import RATE, as_bytes, snapshot
from rigkit.service.sockets import listening, notify, watchdog_seconds
from rigkit.service.stopping import LOCK, address_lock, file_lock
from rigkit.service.web_process import WebProcess, Wires
from rigkit.stop import on_signals

EVENTS = "events.jsonl"
LONGEST_END = 15.0
"""s for a procedure to end."""
_AGAIN = 1.0
"""s after which a web process that died is started again."""
_WEB_END = 3.0


class Service:
    """A daemon from its start to its end; a context manager.

    Parameters
    ----------
    rig : Rig
    settings : Daemon
    file : Path, optional
        The rig file, by which STOP finds this process whatever has become of what is in it.

    Raises
    ------
    ValueError : the settings let in whom they should not, or another daemon uses the data folder; nothing is begun.
    OSError : the data folder cannot be made, or nobody can listen at the address.
    """

    def __init__(self, rig: Rig, settings: Daemon, file: Path | None = None) -> None:
        refuse_open(settings)
        data = Path(settings.data)
        (data / RUNS).mkdir(parents=True, exist_ok=True)
        self._held = ExitStack()
        self._held.callback(Lock(data / LOCK).release)
        try:
            self._held.callback(MachineLock(address_lock(settings.address)).release)
            if file is not None:
                with suppress(DeviceInUseError):  # another daemon has the same file, and an address of its own
                    self._held.callback(MachineLock(file_lock(file)).release)
            self._tokens = tokens_at(data / TOKENS)
            self._listener = listening(address_of(settings.address))
        except BaseException:
            self._held.close()
            raise
        self._settings, self._slot = settings, Slot()
        self.journal = Journal(data / EVENTS)
        self.control = Control(rig, Lease(settings.lease), self.journal)
        self._commands = Commands(self.control)
        self._web: WebProcess | None = None
        self._web_died = 0.0
        self.ended = threading.Event()
        """Set to end the daemon."""

    def __enter__(self) -> Self:
        """Show the rig, and start the web process."""
        self._show(0, 0)
        self._start_web()
        self.journal.add("started", DAEMON, {"address": self._settings.address})
        return self

    def __exit__(self, *_: object) -> None:
        """Stop, and give up everything."""
        notify("STOPPING=1")
        self.control.close(LONGEST_END)
        self.journal.add("ended", DAEMON, {})
        if self._web is not None:
            self._web.end(_WEB_END)
        self._listener.close()
        path = address_of(self._settings.address).path
        if path:
            Path(path).unlink(missing_ok=True)
        self.journal.close()
        self._held.close()

    def run(self) -> None:
        """Show the rig 25 times a second until `ended` is set."""
        period, tick, late = 1.0 / RATE, 0, 0
        patience = watchdog_seconds()
        told = began = time.monotonic()
        notify("READY=1")
        while not self.ended.is_set():
            tick += 1
            due = began + tick * period
            self.ended.wait(max(0.0, due - time.monotonic()))
            now = time.monotonic()
            if now - due > period / 2:
                late += 1
                began += now - due  # what was missed is not made up for
            self.control.settle()
            self._show(tick, late)
            self._keep_web(now)
            if patience is not None and now - told > patience / 4:
                told = now
                notify(f"WATCHDOG=1\nSTATUS={self.control.machine.state}")

    def reload(self) -> None:
        """Read the rig file again; what is wrong with it is in the event log."""
        try:
            self.control.reload_for("signal")
        except (ValueError, OSError) as fault:
            self.journal.add("reload refused", "signal", {"why": str(fault)})

    def _show(self, tick: int, late: int) -> None:
        self._slot.put(as_bytes(snapshot(self.control, tick, late, time.monotonic())))

    def _start_web(self) -> None:
        context = multiprocessing.get_context("spawn")
        theirs = []
        for _ in range(3):
            ours, their = context.Pipe()
            serve(ours, self._commands.answer)
            theirs.append(their)
        asking, urgent, notes = theirs
        wires = Wires(self._slot, asking, urgent, notes, self._listener)
        self._web = WebProcess(self._settings, self._tokens, self.control.rig.program, wires)

    def _keep_web(self, now: float) -> None:
        """Start the web process again when it has died: the rig goes on meanwhile, and signals still stop it."""
        if self._web is None or self._web.exit_code is None:
            return
        if not self._web_died:
            self._web_died = now
            self.journal.add("web process died", DAEMON, {"exit_code": self._web.exit_code})
        elif now - self._web_died > _AGAIN:
            self._web_died = 0.0
            self._start_web()


def run(rig: Rig, settings: Daemon, say: Callable[[str], None], file: Path | None = None) -> None:
    """Run a daemon until SIGTERM or Ctrl-C; SIGUSR1 is a STOP that needs no web process, SIGHUP a reload.

    Parameters
    ----------
    rig : Rig
    settings : Daemon
    say : callable(str)
        For a line to whoever started it.
    file : Path, optional
        The rig file.
    """
    logging.getLogger("uvicorn").setLevel(logging.WARNING)
    with Service(rig, settings, file) as service:
        calls: dict[int, Callable[[], object]] = {
            signal.SIGINT: service.ended.set,
            signal.SIGTERM: service.ended.set,
            signal.SIGUSR1: lambda: service.control.stop("signal", "SIGUSR1"),
            signal.SIGHUP: service.reload,
        }
        with on_signals(calls):
            say(
                f"{rig.program} daemon for {rig.name} at {settings.address}, DISARMED; tokens are in "
                f"{settings.data}/{TOKENS}; Ctrl-C stops it and ends"
            )
            service.run()
