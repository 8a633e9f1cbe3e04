"""A daemon from Python: look at it, take control, command it, watch it."""

import json
import ssl
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, Self

import httpx
from websocket import WebSocket, WebSocketException, create_connection

from rigkit.service.access import TOKENS, Address, address_of, read_tokens
from rigkit.service.config import Daemon
from rigkit.service.gate import STREAM
from rigkit.service.sockets import connected

SECONDS = 12.0
"""Longest wait for an answer."""
BEGIN_SECONDS = 75.0
"""s for a procedure to be made, which may take longer than any other answer."""
STOP_SECONDS = 1.5
"""Longest wait for the answer to a STOP, after which there are other ways."""


class DaemonError(ValueError):
    """A daemon has refused, or could not; the text is its one line.

    Parameters
    ----------
    status : int
        Of HTTP; 0 where there was no answer at all.
    text : str
    """

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


class Client:
    """A connection to a daemon; a context manager.

    Parameters
    ----------
    address : str
        As `daemon.address` of the rig file.
    token : str
        To view, or to operate.
    certificate : str
        File of the daemon's TLS certificate, where it has one.
    """

    def __init__(self, address: str, token: str, certificate: str = "") -> None:
        self._at = reachable(address_of(address))
        self._token, self._scheme = token, "https" if certificate else "http"
        self._trusted = ssl.create_default_context(cafile=certificate) if certificate else None
        self._key, self._seconds = "", 0.0
        transport = httpx.HTTPTransport(uds=self._at.path or None, verify=self._trusted or False)
        self._http = httpx.Client(
            base_url=f"{self._scheme}://{self._host}",
            headers={"Authorization": f"Bearer {token}"},
            transport=transport,
            timeout=SECONDS,
        )

    @classmethod
    def of(cls, daemon: Daemon) -> Self:
        """Return a client for the daemon of a rig file on this machine, with the token to operate."""
        tokens = read_tokens(Path(daemon.data) / TOKENS)
        return cls(daemon.address, tokens.operate, daemon.certificate)

    def __enter__(self) -> Self:
        """Return the client itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the connection; control, if there was any, stays until it runs out."""
        self._http.close()

    def ask(
        self, method: str, path: str, body: Mapping[str, Any] | None = None, seconds: float = SECONDS, **query: Any
    ) -> Any:
        """Send one request and return what the answer holds, which may take so many seconds.

        Raises
        ------
        DaemonError : refused, or no answer.
        """
        headers = {"X-Control": self._key} if self._key else {}
        if self._at.path and not Path(self._at.path).is_socket():
            raise DaemonError(0, f"no answer from the daemon at {self._at.path}: there is no such socket")
        try:
            answer = self._http.request(method, path, json=body, params=query or None, headers=headers, timeout=seconds)
            told = answer.json()
        except (httpx.HTTPError, ValueError) as fault:
            raise DaemonError(0, f"no answer from the daemon at {self._host or self._at.path}: {fault}") from None
        if not answer.is_success:
            raise DaemonError(answer.status_code, told["error"])
        return told

    def snapshot(self) -> dict[str, Any]:
        """Return how the rig stands; docs/service.md says what each part means."""
        return dict(self.ask("GET", "/api/snapshot"))

    def events(self, after: int = 0, most: int = 200) -> list[dict[str, Any]]:
        """Return the newest events after event number `after`."""
        return list(self.ask("GET", "/api/events", after=after, most=most))

    def panel(self, name: str) -> dict[str, Any]:
        """Return a panel."""
        return dict(self.ask("GET", f"/api/panels/{name}"))

    def stop(self, who: str, why: str) -> dict[str, Any]:
        """Bring the output to zero and disarm: with any token, with or without control, with any reason."""
        text = why.encode("utf-8", "replace").decode("utf-8")
        return dict(self.ask("POST", "/api/stop", {"who": who, "why": text}, STOP_SECONDS))

    @contextmanager
    def control(self, who: str, over: bool = False) -> Iterator[Self]:
        """Have control for the length of the block; every command renews it.

        Parameters
        ----------
        who : str
        over : bool
            Take it over from whoever has it.
        """
        lease = self.ask("POST", "/api/control", {"who": who, "over": over})
        self._key, self._seconds = lease["key"], lease["seconds"]
        try:
            yield self
        finally:
            try:
                self.ask("DELETE", "/api/control")
            except DaemonError:
                pass  # taken over or run out meanwhile
            finally:
                self._key = ""

    def command(self, name: str, why: str = "") -> dict[str, Any]:
        """Give a command: arm, disarm, hold, resume, abort, acknowledge; within `control`."""
        return dict(self.ask("POST", f"/api/{name}", {"why": why}))

    def begin(self, procedure: str, why: str = "", **options: Any) -> dict[str, Any]:
        """Begin a procedure; within `control`.  One that is refused is a `DaemonError`, however late it is known."""
        asked = {"procedure": procedure, "options": options, "why": why}
        return dict(self.ask("POST", "/api/begin", asked, BEGIN_SECONDS))

    def reload(self) -> dict[str, Any]:
        """Let the daemon read its rig file again; within `control`."""
        return dict(self.ask("POST", "/api/reload"))

    def watch(self) -> Iterator[dict[str, Any]]:
        """Yield snapshots as they come, the newest each time, for ever; within `control` that keeps it.

        Raises
        ------
        DaemonError : the daemon is gone, or has refused.
        """
        try:
            with closing(self._stream()) as stream:
                while text := stream.recv():
                    shown = json.loads(text)
                    stream.send(str(shown["tick"]))
                    self._keep(shown)
                    yield shown
        except (WebSocketException, OSError) as fault:
            raise DaemonError(0, f"the stream of the daemon at {self._host} has ended: {fault}") from None
        raise DaemonError(0, f"the daemon at {self._host} has ended the stream")

    def _stream(self) -> WebSocket:
        """Return a WebSocket that no thread reads beside this one: Python 3.11 has no lock around a TLS connection."""
        return create_connection(
            f"{'wss' if self._trusted else 'ws'}://{self._host}/api/stream",
            SECONDS,
            header=[f"Authorization: Bearer {self._token}"],
            subprotocols=[STREAM],
            suppress_origin=True,
            sslopt={"context": self._trusted} if self._trusted else None,
            socket=connected(self._at, SECONDS) if self._at.path else None,
            http_no_proxy=["*"],
        )

    def _keep(self, shown: Mapping[str, Any]) -> None:
        """Renew control now and then."""
        left = shown["control"]["seconds"] if self._key and shown["control"] else self._seconds
        if left < self._seconds / 2:
            self.ask("PUT", "/api/control")

    @property
    def _host(self) -> str:
        if self._at.path:
            return "localhost"
        return f"[{self._at.host}]:{self._at.port}" if ":" in self._at.host else f"{self._at.host}:{self._at.port}"


def reachable(address: Address) -> Address:
    """Return where a daemon that listens everywhere is reached from its own machine."""
    return Address({"0.0.0.0": "127.0.0.1", "::": "::1"}.get(address.host, address.host), address.port, address.path)
