"""What every request passes before anything looks at it: name, origin, rate, token and size."""

import asyncio
import time
from collections.abc import Awaitable, Callable, Mapping, MutableMapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from rigkit.json_file import JsonError, json_value
from rigkit.json_text import json_text
from rigkit.service.access import Role, Tokens
from rigkit.service.answers import error
from rigkit.service.rate import Rates

LARGEST_BODY = 65_536
"""Bytes of a request."""
BURST = 2.0
"""s of the long-run rate that may come at once."""
TOLD = 1.0, 20.0
"""Refusals of one address that are told, a second in the long run, and at once."""
STOP = "/api/stop"
"""Is never too frequent, nor one too many; with a token of the daemon's it is obeyed whatever else it says."""
PATIENCE = 0.2
"""s that a STOP waits for its own words."""
WITH_BODY = ("POST", "PUT", "PATCH", "DELETE")
"""Methods whose body, where there is one, is JSON."""
AT_A_TIME = 100
"""Requests under way."""
TOKEN = "token."
"""Begins the WebSocket subprotocol that carries the token, since a page can set no header there."""
STREAM = "vibrostage.1"
"""The subprotocol that is spoken."""

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; "
    "form-action 'none'; object-src 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
}
_ENCODED = [(name.lower().encode(), value.encode()) for name, value in _HEADERS.items()]


class Refusal(Exception):
    """A request that goes no further: HTTP status, and why."""

    def __init__(self, status: int, why: str) -> None:
        super().__init__(why)
        self.status = status


@dataclass(frozen=True)
class Rules:
    """What the gate goes by.

    Parameters
    ----------
    names, origins : frozenset of str
        What Host and Origin may be.
    tokens : Tokens
    rate : float, 1/s
        Requests of one address.
    is_open : callable(path) -> bool
        Which paths need no token: the page itself, which holds nothing of the rig.
    refused : callable(fields)
        Told of every refusal.
    """

    names: frozenset[str]
    origins: frozenset[str]
    tokens: Tokens
    rate: float
    is_open: Callable[[str], bool]
    refused: Callable[[Mapping[str, Any]], None]


class Gate:
    """An ASGI application in front of another.

    In `scope["state"]` go on the `role` of whoever asks, and `refused`, which the application calls, with a `Refusal`,
    to have one of its own told.

    Parameters
    ----------
    app : ASGI application
    rules : Rules
    """

    def __init__(self, app: App, rules: Rules) -> None:
        self._app, self._rules = app, rules
        self._requests = Rates(rules.rate, max(1.0, BURST * rules.rate))
        self._told = Rates(*TOLD)
        self._under_way = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        try:
            self._look_at(scope)
        except Refusal as refusal:
            await self._refuse(scope, send, refusal)
            return
        scope.setdefault("state", {})["refused"] = partial(self._tell, scope)
        if scope["type"] == "websocket":
            await self._app(scope, receive, send)
            return
        self._under_way += 1
        try:
            await self._pass(scope, receive, send)
        finally:
            self._under_way -= 1

    async def _pass(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through whole; a body that is too long goes no further, nor one that is no sound JSON."""
        body = await (_words(receive) if _is_stop(scope) else _body(receive))
        if body is None:
            return
        if len(body) > LARGEST_BODY:
            await self._refuse(scope, send, Refusal(413, f"a request of more than {LARGEST_BODY} bytes"))
            return
        if body and scope["method"] in WITH_BODY and not _is_stop(scope) and (wrong := _unsound(body)):
            await answer(send, 400, error(400, wrong))
            return
        messages = [{"type": "http.request", "body": body, "more_body": False}]

        async def whole() -> Message:
            return messages.pop() if messages else await receive()

        async def sending(message: Message) -> None:
            await send(_with_headers(message))

        await self._app(scope, whole, sending)

    def _look_at(self, scope: Scope) -> None:
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        if _is_stop(scope):
            scope.setdefault("state", {})["role"] = self._role(scope, headers)
            return
        if not self._under_way < AT_A_TIME:
            raise Refusal(503, f"{self._under_way} requests are under way, {AT_A_TIME} may be")
        host, origin = headers.get("host", ""), headers.get("origin")
        if host.lower() not in self._rules.names:
            raise Refusal(403, f"the host {host[:80]!r} is not one of this daemon's names (daemon.hosts)")
        if origin is not None and origin.lower() not in self._rules.origins:
            raise Refusal(403, f"the origin {origin[:80]!r} is not a page of this daemon's")
        if int(headers.get("content-length", "0") or 0) > LARGEST_BODY:
            raise Refusal(413, f"a request of {headers['content-length']} bytes, must be <= {LARGEST_BODY}")
        if scope["type"] == "http" and self._rules.is_open(scope["path"]):
            self._refuse_too_frequent(scope, "")
            return
        role = self._role(scope, headers)
        self._refuse_too_frequent(scope, role)
        if scope["type"] == "http" and role != "operate" and scope["method"] not in ("GET", "HEAD"):
            raise Refusal(403, "this token may view and STOP; commands need the one that may operate")
        scope.setdefault("state", {})["role"] = role

    def _refuse_too_frequent(self, scope: Scope, role: str) -> None:
        """Count a request; whoever has no token takes nothing from those of the same address who have one."""
        if not self._requests.allows(f"{_address(scope)} {role}", time.monotonic()):
            raise Refusal(429, "too many requests")

    def _role(self, scope: Scope, headers: Mapping[str, str]) -> Role:
        given = headers.get("authorization", "")
        token = given[7:] if given[:7].lower() == "bearer " else ""
        if scope["type"] == "websocket" and not token:
            offered = (each.strip() for each in headers.get("sec-websocket-protocol", "").split(","))
            token = next((each.removeprefix(TOKEN) for each in offered if each.startswith(TOKEN)), "")
        role = self._rules.tokens.role(token)
        if role is None:
            raise Refusal(401, "the token is not this daemon's" if token else "there is no token")
        return role

    def tell(self, fields: Mapping[str, Any]) -> None:
        """Have told what was refused to the `address` of the fields, but not more often than a log can bear."""
        if self._told.allows(fields["address"], time.monotonic()):
            self._rules.refused(fields)

    def _tell(self, scope: Scope, refusal: Refusal) -> None:
        path, why = scope["path"][:200], str(refusal)
        self.tell({"address": _address(scope), "path": path, "status": refusal.status, "why": why})

    async def _refuse(self, scope: Scope, send: Send, refusal: Refusal) -> None:
        self._tell(scope, refusal)
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": str(refusal)[:120]})
            return
        await answer(send, refusal.status, error(refusal.status, str(refusal)))


async def _body(receive: Receive) -> bytes | None:
    """Return the body, or as much of it as shows that it is too long; None where the client has gone meanwhile."""
    body = bytearray()
    more = True
    while more and len(body) <= LARGEST_BODY:
        message = await receive()
        if message["type"] == "http.disconnect":
            return None
        body += message.get("body", b"")
        more = message.get("more_body", False)
    return bytes(body)


async def _words(receive: Receive) -> bytes:
    """Return what a STOP says of itself, or nothing where that does not come at once, is cut off or without end."""
    try:
        async with asyncio.timeout(PATIENCE):
            body = await _body(receive) or b""
    except TimeoutError:
        return b""
    return body if len(body) <= LARGEST_BODY else b""


def _unsound(body: bytes) -> str:
    """Say what is wrong with a body as JSON; nothing where it can be used."""
    try:
        json_value(body.decode(), "the request", object)
    except UnicodeDecodeError:
        return "the request: not UTF-8"
    except JsonError as fault:
        return str(fault)
    return ""


async def answer(send: Send, status: int, told: Mapping[str, Any]) -> None:
    """Send a whole answer of JSON."""
    headers = [(b"content-type", b"application/json"), *_ENCODED]
    if status == 401:
        headers.append((b"www-authenticate", b"Bearer"))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": json_text(told).encode()})


def _is_stop(scope: Scope) -> bool:
    return (scope["type"], scope.get("method"), scope["path"]) == ("http", "POST", STOP)


def _address(scope: Scope) -> str:
    return str(scope["client"][0]) if scope.get("client") else "socket"


def _with_headers(message: Message) -> Message:
    if message["type"] == "http.response.start":
        own = {name.lower() for name, _ in message.get("headers", ())}
        message["headers"] = [*message.get("headers", ()), *(pair for pair in _ENCODED if pair[0] not in own)]
    return message
