"""HTTP connections on which no whole request has come yet: each has some seconds for one, and the next has room.

Whoever opens connections and says nothing, or says it byte by byte, or sends a body that never ends, needs no token for
it.  Such a connection goes after `WITHIN` seconds; and where there are too many, the oldest goes for the newest, of the
address that has most; but each has a moment first, in which whoever means to ask has asked.  So a STOP gets through
however many there are.
"""

import asyncio
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Protocol

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from rigkit.json_text import json_text
from rigkit.service.answers import error

WITHIN = 5.0
"""s from the first byte, or from the connection, to the end of a request."""
READ_WITHIN = 20.0
"""s in which a client must read on what it has asked for."""
OF_ONE = 32
"""Connections of one address without a whole request."""
IN_ALL = 100
"""And of all addresses."""
GRACE = 0.5
"""s that each of them has, however many there are, ..."""
AT_ONCE = 4_000
"""... up to so many."""

Tell = Callable[[Mapping[str, Any]], None]


class Closing(Protocol):
    """A connection that can be closed."""

    def give_up(self, status: int, why: str) -> None:
        """Close it, and say why to whoever keeps the log."""


class Waiting:
    """The connections without a whole request, in the order in which they came, by address.

    Parameters
    ----------
    tell : callable(fields)
        Told of every connection that is closed: address, path (empty), status and why.
    """

    def __init__(self, tell: Tell) -> None:
        self.tell = tell
        self._since: dict[str, dict[Closing, float]] = {}
        self._all = 0

    def __len__(self) -> int:
        """Return how many there are."""
        return self._all

    def add(self, connection: Closing, address: str, now: float) -> None:
        """Take one more at the time `now`, s; where there are too many, the oldest go, if they have had `GRACE`."""
        self.remove(connection, address)
        self._since.setdefault(address, {})[connection] = now
        self._all += 1
        while self._makes_room(address, now):
            pass

    def remove(self, connection: Closing, address: str) -> None:
        """Forget one: it has asked, or has gone."""
        its = self._since.get(address, {})
        if its.pop(connection, None) is not None:
            self._all -= 1
            if not its:
                del self._since[address]

    def _makes_room(self, address: str, now: float) -> bool:
        """Close the oldest connection of an address that has too many; tell whether there was one."""
        if len(self._since[address]) <= OF_ONE:
            if self._all <= IN_ALL:
                return False
            address = max(self._since, key=lambda each: len(self._since[each]))
        its = self._since[address]
        oldest, since = next(iter(its.items()))
        if now - since < GRACE and self._all <= AT_ONCE:
            return False
        why = f"{len(its)} connections of this address without a whole request, {OF_ONE} may be"
        self.remove(oldest, address)
        oldest.give_up(503, why)
        return True


class PatientProtocol(H11Protocol):
    """uvicorn's HTTP/1.1 with an end to its patience; a subclass of `bound` is what a server is given."""

    waiting: ClassVar[Waiting]
    _late: asyncio.TimerHandle | None = None
    _unread: asyncio.TimerHandle | None = None
    _is_idle = False
    """Between an answer and the next request, which is uvicorn's own `timeout_keep_alive`."""

    @classmethod
    def bound(cls, waiting: Waiting) -> type["PatientProtocol"]:
        """Return the class for one server."""
        return type(cls.__name__, (cls,), {"waiting": waiting})

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request."""
        super().connection_made(transport)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        self._wait_no_longer()
        self._has_read()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take bytes; a request that is whole with them is waited for no longer."""
        if self._is_idle:
            self._is_idle = False
            self._wait()
        super().data_received(data)
        if self._is_whole():
            self._wait_no_longer()

    def on_response_complete(self) -> None:
        """Be idle until the next request begins, unless the rest of this one is yet to come."""
        super().on_response_complete()
        if self.conn.their_state is h11.SEND_BODY:
            return
        self._wait_no_longer()
        if not self.transport.is_closing():
            self._is_idle = True
            self.waiting.add(self, self._address, self.loop.time())

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Hand the connection over."""
        self._wait_no_longer()
        super().handle_websocket_upgrade(event)

    def pause_writing(self) -> None:
        """Wait for the client to read what it has asked for, but not for ever."""
        super().pause_writing()
        self._unread = self.loop.call_later(READ_WITHIN, self.give_up, 408, f"nothing read for {READ_WITHIN:g} s")

    def resume_writing(self) -> None:
        """Go on: it has read."""
        super().resume_writing()
        self._has_read()

    def timeout_keep_alive_handler(self) -> None:
        """Close an idle connection, whether or not its last answer is read."""
        super().timeout_keep_alive_handler()
        self.loop.call_later(READ_WITHIN, self.transport.abort)

    def send_400_response(self, msg: str) -> None:
        """Answer what is no HTTP as everything else is answered, with JSON."""
        body = json_text(error(400, msg)).encode()
        head = [(b"content-type", b"application/json"), (b"connection", b"close")]
        for event in (h11.Response(status_code=400, headers=head), h11.Data(data=body), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event) or b"")
        self.transport.close()

    def give_up(self, status: int, why: str) -> None:
        """Close the connection at once."""
        self._wait_no_longer()
        if not self.transport.is_closing():
            self.transport.abort()
            if status != 503 or not self._is_idle:
                self.waiting.tell({"address": self._address, "path": "", "status": status, "why": why})

    @property
    def _address(self) -> str:
        return str(self.client[0]) if self.client else "socket"

    def _is_whole(self) -> bool:
        return self.cycle is not None and not self.cycle.more_body and not self.cycle.response_complete

    def _has_read(self) -> None:
        if self._unread is not None:
            self._unread.cancel()
            self._unread = None

    def _wait(self) -> None:
        self._wait_no_longer()
        self._late = self.loop.call_later(WITHIN, self.give_up, 408, f"no whole request within {WITHIN:g} s")
        self.waiting.add(self, self._address, self.loop.time())

    def _wait_no_longer(self) -> None:
        if self._late is not None:
            self._late.cancel()
            self._late = None
        self.waiting.remove(self, self._address)
