"""The WebSocket stream: the newest snapshot to everybody who reads, and to nobody who does not."""

import asyncio
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress

from starlette.types import Message
from starlette.websockets import WebSocket, WebSocketDisconnect

from rigkit.service.gate import STREAM
from rigkit.service.slot import Slot

WINDOW = 5
"""Snapshots that may be on their way to a client; the next is the newest there is when it has said that it read one."""
PATIENCE = 1.5
"""s that a client may take to read a snapshot; one that takes longer is closed."""
LOOK = 0.01
"""s between two looks for a new snapshot."""

_NOT_AS_IT_MUST_BE = (1002, 1007, 1009)
"""Codes with which a WebSocket is closed for what came through it: no frame, no text, too long."""


class _Client:
    """One WebSocket: what is on its way to it, and whether there is news."""

    def __init__(self) -> None:
        self.sent: deque[tuple[int, float]] = deque()
        self.seen = 0
        self.moved = asyncio.Event()
        self.is_over = False

    def read(self, tick: int) -> bool:
        """Take note that everything up to `tick` was read; say whether that had been sent."""
        if tick not in (number for number, _ in self.sent):
            return False
        while self.sent and self.sent[0][0] <= tick:
            self.sent.popleft()
        self.moved.set()
        return True

    def is_stalled(self) -> bool:
        """Whether it has not read a snapshot for too long."""
        return bool(self.sent) and time.monotonic() - self.sent[0][1] > PATIENCE


class Audience:
    """Everybody who watches.  A client answers each snapshot with its tick, as text.

    Parameters
    ----------
    slot : Slot
        Where the rig's process puts snapshots.
    most : int
        Clients at a time.
    dropped : callable(str, str)
        Told of a client that is closed: where it is, and why.
    """

    def __init__(self, slot: Slot, most: int, dropped: Callable[[str, str], None]) -> None:
        self._slot, self._most, self._dropped = slot, most, dropped
        self._clients: set[_Client] = set()
        self._count, self._text = 0, ""
        self.came = self.sent = self.stalled = 0

    @property
    def size(self) -> int:
        """How many watch."""
        return len(self._clients)

    async def follow(self) -> None:
        """Look for snapshots for ever, and wake the clients."""
        while True:
            if self._slot.count != self._count and (content := self._slot.get()) is not None:
                self._count, self._text = self._slot.count, content.decode()
                for client in self._clients:
                    client.moved.set()
            await asyncio.sleep(LOOK)

    async def attend(self, socket: WebSocket) -> None:
        """Serve one WebSocket until it goes, or does not read."""
        if self.size >= self._most:
            self._dropped(_place(socket), f"{self._most} watch already (daemon.clients)")
            await socket.close(1013)
            return
        client = _Client()
        self._clients.add(client)
        self.came += 1
        try:
            await socket.accept(subprotocol=STREAM if STREAM in socket.scope["subprotocols"] else None)
            reader = asyncio.create_task(self._read(socket, client))
            try:
                await self._write(socket, client)
            except (RuntimeError, WebSocketDisconnect):  # gone between two snapshots: the reader is told why
                await reader
            finally:
                reader.cancel()
                with suppress(asyncio.CancelledError):
                    await reader
        finally:
            self._clients.discard(client)

    async def _write(self, socket: WebSocket, client: _Client) -> None:
        """Send; returns, which cuts the line without ceremony, when the client is stalled or gone."""
        while not client.is_over:
            if client.is_stalled():
                self.stalled += 1
                self._dropped(_place(socket), f"it has not read a snapshot for {PATIENCE:g} s")
                return
            if self._count != client.seen and self._text and len(client.sent) < WINDOW:
                client.seen = self._count
                client.sent.append((_tick(self._text), time.monotonic()))
                self.sent += 1
                await socket.send_text(self._text)
            else:
                client.moved.clear()
                await client.moved.wait()

    async def _read(self, socket: WebSocket, client: _Client) -> None:
        with suppress(RuntimeError):  # gone
            while not client.is_over:
                message = await socket.receive()
                client.is_over, why = _judged(message, client)
                if why:
                    self._dropped(_place(socket), why)
        client.is_over = True
        client.moved.set()


def _judged(message: Message, client: _Client) -> tuple[bool, str]:
    """Say whether a message ends a line, and why where that is to be told."""
    if message["type"] == "websocket.disconnect":
        why = message.get("reason") or f"it breaks the protocol, {message['code']}"
        return True, why if message["code"] in _NOT_AS_IT_MUST_BE else ""
    if message.get("text") is None:
        return True, "it sends bytes, must be text"
    text = message["text"][:20]
    if text.isascii() and text.isdigit() and client.read(int(text)):
        return False, ""
    return True, f"it says {text!r}, which is not the tick of a snapshot sent to it"


def _tick(text: str) -> int:
    """Return the tick of a snapshot, which begins with it."""
    return int(text[len('{"tick": ') : text.index(",")])


def _place(socket: WebSocket) -> str:
    return socket.client.host if socket.client else "socket"
