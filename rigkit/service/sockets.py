"""The daemon's own sockets: the one it listens at, and the one it tells systemd by."""

import os
import socket
import stat
from pathlib import Path

from rigkit.service.access import Address

Listener = socket.socket
"""What takes connections."""
WAITING = 64
"""Connections that may wait to be accepted."""


def listening(address: Address) -> Listener:
    """Listen; a socket in the file system is for its owner alone.

    Raises
    ------
    OSError : the address is in use, or is none of this machine's.
    """
    made = _at_path(address.path) if address.path else _at_port(address)
    made.listen(WAITING)
    return made


def notify(text: str) -> None:
    """Tell systemd, where it started this program with `Type=notify`: "READY=1", "WATCHDOG=1", ...

    Source
    ------
    sd_notify(3): one datagram to the socket that NOTIFY_SOCKET names; "@" begins an abstract one.
    """
    name = os.environ.get("NOTIFY_SOCKET", "")
    if not name.startswith(("/", "@")):
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as to:
        to.setblocking(False)
        try:
            to.sendto(text.encode(), f"\0{name[1:]}" if name[0] == "@" else name)
        except OSError:
            return  # nobody listens: there is nothing to do about it


def watchdog_seconds() -> float | None:
    """Return how often systemd wants a sign, s; None where it wants none from this process."""
    if os.environ.get("WATCHDOG_PID", str(os.getpid())) != str(os.getpid()):
        return None
    microseconds = os.environ.get("WATCHDOG_USEC", "")
    return int(microseconds) / 1e6 if microseconds.isdigit() and int(microseconds) else None


def _at_port(address: Address) -> socket.socket:
    where = f"{address.host}:{address.port}"
    try:
        family, _, _, _, at = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)[0]
        made = socket.socket(family, socket.SOCK_STREAM)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(at)
    except (OSError, OverflowError) as fault:
        reason = fault.strerror if isinstance(fault, OSError) else "a port is 0 to 65535"
        raise OSError(f"daemon.address is {where}, where nobody can listen: {reason}") from None
    return made


def _at_path(path: str) -> socket.socket:
    made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        if Path(path).exists() and stat.S_ISSOCK(Path(path).stat().st_mode) and not answers(Address(path=path)):
            Path(path).unlink()
        before = os.umask(0o177)
        try:
            made.bind(path)
        finally:
            os.umask(before)
    except OSError as fault:
        raise OSError(f"daemon.address is unix:{path}, where nobody can listen: {fault.strerror or fault}") from None
    return made


def connected(at: Address, seconds: float) -> socket.socket:
    """Return a connection to an address, that waits no longer than so many seconds.

    Raises
    ------
    OSError : nobody listens there.
    """
    family = socket.AF_UNIX if at.path else socket.AF_INET6 if ":" in at.host else socket.AF_INET
    made = socket.socket(family, socket.SOCK_STREAM)
    try:
        made.settimeout(seconds)
        made.connect(at.path or (at.host, at.port))
    except OSError:
        made.close()
        raise
    return made


def answers(at: Address) -> bool:
    """Whether something takes a connection at an address within a second."""
    try:
        connected(at, 1.0).close()
    except BlockingIOError:  # a socket in the file system at which more than `WAITING` wait
        return True
    except OSError:
        return False
    return True
