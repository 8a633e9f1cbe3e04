"""Who may reach the daemon: where it listens, under which names, and with which token."""

import ipaddress
import os
import secrets
import stat
import tomllib
from contextlib import suppress
from dataclasses import dataclass
from hmac import compare_digest
from pathlib import Path
from typing import Literal

from ctlblocks.room import writing
from rigkit.service.config import Daemon

TOKENS = "token"
"""Name of the file with the tokens, in the data folder."""

Role = Literal["view", "operate"]


@dataclass(frozen=True)
class Address:
    """Where the daemon listens: a host and a port, or a path of a socket.

    Parameters
    ----------
    host : str
        Empty for a socket in the file system.
    port : int
    path : str
        Empty for host and port.
    """

    host: str = ""
    port: int = 0
    path: str = ""

    @property
    def is_of_this_machine(self) -> bool:
        """Whether nobody from elsewhere can reach it."""
        if self.path or self.host == "localhost":
            return True
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return False


def address_of(text: str) -> Address:
    """Read "host:port", "[v6 address]:port" or "unix:/path"."""
    if text.startswith("unix:"):
        return Address(path=text.removeprefix("unix:"))
    host, _, port = text.rpartition(":")
    return Address(host.strip("[]"), int(port))


def refuse_open(daemon: Daemon) -> None:
    """Refuse to listen where others reach it without TLS, unless the rig file says that it may.

    Raises
    ------
    ValueError
    """
    if bool(daemon.certificate) != bool(daemon.key):
        raise ValueError("daemon.certificate and daemon.key go together: one of them is empty")
    if not (address_of(daemon.address).is_of_this_machine or daemon.certificate or daemon.plain):
        raise ValueError(
            f"daemon.address is {daemon.address}, which other machines reach: give daemon.certificate and daemon.key, "
            "or set daemon.plain = true to let tokens and commands go unencrypted"
        )


def names(daemon: Daemon) -> frozenset[str]:
    """Return what a request may have in its Host header."""
    address = address_of(daemon.address)
    if address.path:
        return frozenset(("localhost", *daemon.hosts))
    own = {"127.0.0.1", "localhost", "[::1]", f"[{address.host}]" if ":" in address.host else address.host}
    own -= {"0.0.0.0", "[::]"}
    standard = {443 if daemon.certificate else 80: frozenset(own)}.get(address.port, frozenset())
    return frozenset(f"{host}:{address.port}" for host in own) | standard | frozenset(daemon.hosts)


def origins(daemon: Daemon) -> frozenset[str]:
    """Return which pages' scripts may ask: those that came from here."""
    scheme = "https" if daemon.certificate else "http"
    return frozenset(f"{scheme}://{name}" for name in names(daemon))


@dataclass(frozen=True)
class Tokens:
    """What proves a role: `view` sees all and may STOP, `operate` commands as well."""

    view: str
    operate: str

    def role(self, token: str) -> Role | None:
        """Return the role that a token gives, None for none."""
        given = token.encode()
        operates, views = (compare_digest(own.encode(), given) for own in (self.operate, self.view))
        return "operate" if operates else "view" if views else None


def new_tokens(path: Path) -> Tokens:
    """Make tokens, and the file that only its owner can read in the place of the one there was."""
    made = Tokens(secrets.token_urlsafe(32), secrets.token_urlsafe(32))
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    text = f'view = "{made.view}"\noperate = "{made.operate}"\n'
    try:
        with writing(path, len(text), temporary):
            handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(handle, "w") as file:
                file.write(text)
                file.flush()
                os.fsync(handle)
            temporary.replace(path)
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
    return made


def read_tokens(path: Path) -> Tokens:
    """Read the file of tokens.

    Raises
    ------
    ValueError : others can read it, or it does not hold two tokens.
    OSError : it cannot be read.
    """
    with path.open("rb") as file:
        mode = stat.S_IMODE(os.fstat(file.fileno()).st_mode)
        if mode & 0o077:
            raise ValueError(f"{path} can be read by others, mode {mode:03o}: chmod 600, after making new tokens")
        try:
            held = tomllib.load(file)
            made = Tokens(str(held["view"]), str(held["operate"]))
        except (ValueError, KeyError, RecursionError):
            raise ValueError(f"{path} does not hold the tokens view and operate") from None
    if min(len(made.view), len(made.operate)) < 32 or made.view == made.operate:
        raise ValueError(f"{path}: its tokens are alike or shorter than 32 letters")
    return made


def tokens_at(path: Path) -> Tokens:
    """Read the file of tokens; make it where there is none."""
    return read_tokens(path) if path.exists() else new_tokens(path)
