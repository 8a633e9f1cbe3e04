"""So many requests may be under way at a time, and a STOP beside them; those that have gone make room."""

import asyncio

from rigkit.service.gate import AT_A_TIME, STOP, Gate, Message, Receive, Rules, Scope, Send
from tests.rigkit.service.test_gate import OPERATE, TOKENS


class Slow:
    """An application that answers when it is let."""

    def __init__(self) -> None:
        self.inside, self.go = 0, asyncio.Event()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.inside += 1
        if scope["path"] != STOP:
            await self.go.wait()
        self.inside -= 1
        await send({"type": "http.response.start", "status": 200, "headers": []})


async def ask(gate: Gate, path: str) -> int:
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    headers = [(name.encode(), value.encode()) for name, value in OPERATE.items()]
    scope = {"type": "http", "path": path, "method": "POST", "headers": headers, "client": ("127.0.0.1", 5)}
    await gate(scope, receive, send)
    return int(sent[0]["status"])


async def crowd() -> tuple[list[int], int, int, int]:
    """Ask once too often while none is answered; return their statuses, a STOP's meanwhile, and one's afterwards."""
    slow, told = Slow(), []
    names = frozenset({"localhost:8787"})
    gate = Gate(slow, Rules(names, frozenset(), TOKENS, 1e6, lambda _: False, told.append))
    asked = [asyncio.create_task(ask(gate, "/api/settings")) for _ in range(AT_A_TIME)]
    while slow.inside < AT_A_TIME:
        await asyncio.sleep(0)
    one_more, stop = await ask(gate, "/api/settings"), await ask(gate, STOP)
    slow.go.set()
    statuses = [await each for each in asked]
    assert [each["why"] for each in told] == [f"{AT_A_TIME} requests are under way, {AT_A_TIME} may be"]
    return statuses, one_more, stop, await ask(gate, "/api/settings")


def test_one_more_than_may_be_under_way_is_refused_a_stop_is_not_and_then_there_is_room_again() -> None:
    statuses, one_more, stop, afterwards = asyncio.run(crowd())
    assert statuses == [200] * AT_A_TIME
    assert (one_more, stop, afterwards) == (503, 200, 200)
