"""STOP from a shell, by every way there is: the daemon's page, and a signal to the process that runs it."""

import getpass
import os
import signal
from collections.abc import Iterator
from pathlib import Path

from rigkit import os_fault
from rigkit.lock import holder
from rigkit.machine_lock import holder_of
from rigkit.service.access import address_of
from rigkit.service.client import Client, DaemonError, reachable
from rigkit.service.config import Daemon
from rigkit.service.sockets import answers

LOCK = ".lock"
"""In a daemon's data folder."""


def address_lock(address: str) -> str:
    """Return by which name a daemon holds its address on this machine."""
    at = reachable(address_of(address))
    return f"daemon at {at.path or f'port {at.port}'}"


def file_lock(file: Path) -> str:
    """Return by which name a daemon holds its rig file on this machine."""
    return f"daemon of {file.resolve()}"


def stopped(table: Daemon | str, file: Path | None, token: Path | None, why: str) -> str:
    """Stop the rig of a daemon; return in a line how.

    Parameters
    ----------
    table : Daemon or str
        Or what is wrong with it.
    file : Path or None
        The rig file.
    token : Path, optional
        File that holds one alone.
    why : str
        For the event log.

    Raises
    ------
    ValueError : no way has led to it; each is named with what was wrong.
    """
    faults = [f"by its page: {table}"] if isinstance(table, str) else []
    if not isinstance(table, str):
        try:
            with client_of(table, token) as client:
                told = client.stop(getpass.getuser(), why)
            return f"stopped: {told['before']} -> {told['state']}"
        except (DaemonError, OSError, ValueError) as fault:
            faults.append(f"by its page: {_said(fault)}")
    for where, process in _processes(table, file):
        if process is None:
            faults.append(f"by a signal: no daemon {where}")
            continue
        try:
            os.kill(process, signal.SIGUSR1)
        except OSError as fault:
            faults.append(f"by a signal to process {process}, which {where}: {_said(fault)}")
            continue
        return f"process {process}, which {where}, was stopped by a signal, its page could not be reached: {faults[0]}"
    raise ValueError(f"nothing was stopped{_at(table)} {'; '.join(faults)}")


def _at(table: Daemon | str) -> str:
    """Say where nothing was stopped, and whether something is there all the same."""
    if isinstance(table, str):
        return ":"
    return f" at {table.address};{' something answers there, though:' if is_answered(table) else ''}"


def _processes(table: Daemon | str, file: Path | None) -> Iterator[tuple[str, int | None]]:
    """Yield which processes may be the daemon, and where that is known from."""
    if not isinstance(table, str):
        yield f"works in {table.data}/", holder(Path(table.data) / LOCK)
        yield f"has the address {table.address}", holder_of(address_lock(table.address))
    if file is not None:
        yield f"was started with {file}", holder_of(file_lock(file))


def client_of(table: Daemon, token: Path | None) -> Client:
    """Return a client for a daemon, with the token in a file, or with the one that its own file has to operate.

    Raises
    ------
    OSError : the file cannot be read.
    """
    if token is None:
        return Client.of(table)
    return Client(table.address, token.read_text(encoding="utf-8").strip(), table.certificate)


def is_answered(table: Daemon) -> bool:
    """Whether something on this machine answers at a daemon's address."""
    return answers(reachable(address_of(table.address)))


def _said(fault: Exception) -> str:
    return os_fault.told(fault) if isinstance(fault, OSError) else str(fault)
