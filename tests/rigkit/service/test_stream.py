"""A client that goes in the middle: what it did is told, whichever of the two that serve it sees it first."""

import asyncio
from typing import Any

import pytest
from starlette.websockets import WebSocket

from rigkit.service.slot import Slot
from rigkit.service.stream import Audience
from tests.until import EVER


class Line:
    """A WebSocket's server's side, which is closed for `reason` while the first snapshot is being sent."""

    def __init__(self, code: int, reason: str, failure: Exception) -> None:
        self.end, self.failure = {"type": "websocket.disconnect", "code": code, "reason": reason}, failure
        self.heard: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self.heard.put_nowait({"type": "websocket.connect"})

    async def send(self, message: Any) -> None:
        """Accept; with the first snapshot the line is closed, as uvicorn does: told to the reader, failing here."""
        if message["type"] == "websocket.send":
            self.heard.put_nowait(self.end)
            raise self.failure

    def served(self) -> WebSocket:
        scope = {"type": "websocket", "subprotocols": [], "client": ("192.0.2.1", 1), "path": "/", "headers": []}
        return WebSocket(scope, self.heard.get, self.send)


@pytest.mark.parametrize("failure", [RuntimeError("closed"), OSError("gone")])
@pytest.mark.parametrize(
    ("code", "told"),
    [(1009, [("192.0.2.1", "too long")]), (1005, [])],
)
def test_what_closed_a_line_is_told_even_where_sending_fails_first(
    failure: Exception, code: int, told: list[tuple[str, str]]
) -> None:
    slot = Slot()
    slot.put(b'{"tick": 1, "state": {}}')
    dropped: list[tuple[str, str]] = []
    audience = Audience(slot, 1, lambda place, why: dropped.append((place, why)))

    async def attended() -> None:
        following = asyncio.create_task(audience.follow())
        await asyncio.wait_for(audience.attend(Line(code, "too long", failure).served()), EVER)
        following.cancel()

    asyncio.run(attended())
    assert dropped == told
    assert audience.size == 0
