"""What passes the gate, and what does not: by hand-made ASGI messages, so that nothing is normalised on the way."""

import asyncio
from collections.abc import Mapping
from typing import Any

import pytest

from rigkit.service.access import Tokens
from rigkit.service.gate import LARGEST_BODY, Gate, Message, Receive, Rules, Scope, Send

TOKENS = Tokens("v" * 40, "o" * 40)
OURS = {"host": "localhost:8787"}
OPERATE = {**OURS, "authorization": "Bearer " + TOKENS.operate}
VIEW = {**OURS, "authorization": "Bearer " + TOKENS.view}


NEVER, GONE = b"a part that never comes", b"no part, but the end of the connection"


class Behind:
    """The application behind the gate: it reads the body, and answers 200."""

    def __init__(self) -> None:
        self.reached = 0
        self.body = b""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.reached += 1
        if scope["type"] == "websocket":
            await send({"type": "websocket.accept"})
            return
        more = True
        while more:
            message = await receive()
            self.body += message.get("body", b"")
            more = message.get("more_body", False)
        await send({"type": "http.response.start", "status": 200, "headers": []})


class Door:
    """A gate, what is behind it and what it told of refusals."""

    def __init__(self, rate: float = 1000.0) -> None:
        self.behind, self.told = Behind(), list[Mapping[str, Any]]()
        names = frozenset({"localhost:8787"})
        origins = frozenset({"http://localhost:8787"})
        self._gate = Gate(self.behind, Rules(names, origins, TOKENS, rate, lambda path: path == "/", self.told.append))

    def ask(
        self, path: str, headers: Mapping[str, str], method: str = "POST", parts: tuple[bytes, ...] = (b"",)
    ) -> int:
        """Return the status of the answer; 0 where there is none."""
        return int((*self._through("http", path, headers, method, parts), {"status": 0})[0]["status"])

    def connect(self, headers: Mapping[str, str]) -> str:
        """Return how a WebSocket is answered."""
        return str(self._through("websocket", "/api/stream", headers, "GET", ())[0]["type"])

    def headers(self, path: str, headers: Mapping[str, str]) -> dict[bytes, bytes]:
        """Return the headers of the answer."""
        return dict(self._through("http", path, headers, "GET", (b"",))[0]["headers"])

    def _through(
        self, kind: str, path: str, headers: Mapping[str, str], method: str, parts: tuple[bytes, ...]
    ) -> list[Message]:
        sent: list[Message] = []
        waiting = [
            {"type": "http.request", "body": part, "more_body": n + 1 < len(parts)} for n, part in enumerate(parts)
        ]

        async def receive() -> Message:
            message = waiting.pop(0)
            if message["body"] == NEVER:
                await asyncio.Event().wait()
            return {"type": "http.disconnect"} if message["body"] == GONE else message

        async def send(message: Message) -> None:
            sent.append(message)

        encoded = [(name.encode(), value.encode("latin-1")) for name, value in headers.items()]
        scope = {"type": kind, "path": path, "method": method, "headers": encoded, "client": ("127.0.0.1", 5)}
        asyncio.run(self._gate(scope, receive, send))
        return sent


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        (OPERATE, 200),
        ({**OPERATE, "origin": "http://localhost:8787"}, 200),
        ({**OPERATE, "host": "LOCALHOST:8787"}, 200),
        ({**OPERATE, "host": "evil.example:8787"}, 403),
        ({**OPERATE, "host": "localhost"}, 403),
        ({**OPERATE, "host": ""}, 403),
        ({**OPERATE, "origin": "http://evil.example"}, 403),
        ({**OPERATE, "origin": "https://localhost:8787"}, 403),
        ({**OPERATE, "origin": "null"}, 403),
        (OURS, 401),
        ({**OURS, "authorization": "Bearer "}, 401),
        ({**OURS, "authorization": "Bearer " + "x" * 43}, 401),
        ({**OURS, "authorization": "Basic " + TOKENS.operate}, 401),
        ({**OURS, "authorization": "Bearer \xe9"}, 401),
        (VIEW, 403),
        ({**OPERATE, "content-length": str(LARGEST_BODY)}, 200),
        ({**OPERATE, "content-length": str(LARGEST_BODY + 1)}, 413),
    ],
)
def test_a_command_passes_with_the_right_host_origin_and_token_alone(headers: dict[str, str], status: int) -> None:
    door = Door()
    assert door.ask("/api/arm", headers) == status
    assert door.behind.reached == (status == 200)
    assert [told["status"] for told in door.told] == ([] if status == 200 else [status])


def test_a_viewer_may_look() -> None:
    assert Door().ask("/api/snapshot", VIEW, "GET") == 200


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS"])
def test_a_viewer_may_change_nothing(method: str) -> None:
    assert Door().ask("/api/snapshot", VIEW, method) == 403


@pytest.mark.parametrize(
    ("path", "method", "headers", "status"),
    [
        ("/api/stop", "POST", VIEW, 200),
        ("/api/stop", "POST", OPERATE, 200),
        ("/api/stop", "POST", OURS, 401),
        ("/api/stop", "POST", {**VIEW, "authorization": "Bearer " + "x" * 43}, 401),
        ("/api/stop", "POST", {**VIEW, "host": "10.0.0.5:8787"}, 200),
        ("/api/stop", "POST", {**VIEW, "origin": "http://evil.example"}, 200),
        ("/api/stop", "POST", {**VIEW, "content-length": "9999999"}, 200),
        ("/api/stop", "GET", {**VIEW, "host": "evil.example"}, 403),
        ("/api/stop", "PUT", VIEW, 403),
        ("/api/stop", "DELETE", VIEW, 403),
        ("/api/stop/", "POST", VIEW, 403),
        ("/api/stop/../arm", "POST", VIEW, 403),
        ("/api/Stop", "POST", VIEW, 403),
    ],
)
def test_any_token_may_stop_and_by_this_one_request(
    path: str, method: str, headers: dict[str, str], status: int
) -> None:
    assert Door().ask(path, headers, method) == status


@pytest.mark.parametrize("body", [b"{", b"\xff", b'"\\ud800"', b"[" * 20_000, b'{"who": NaN}', b'{"why": 1, "why": 2}'])
def test_the_words_of_a_stop_are_for_whoever_obeys_it(body: bytes) -> None:
    door = Door()
    assert door.ask("/api/stop", VIEW, parts=(body,)) == 200
    assert door.behind.body == body
    assert Door().ask("/api/arm", OPERATE, parts=(body,)) == 400


def test_a_stop_whose_words_have_no_end_or_never_come_goes_through_without_them() -> None:
    door = Door()
    assert door.ask("/api/stop", VIEW, parts=(b"x" * 50_000,) * 3) == 200
    assert (door.behind.reached, door.behind.body) == (1, b"")
    door = Door()
    assert door.ask("/api/stop", VIEW, parts=(b'{"why', NEVER)) == 200
    assert (door.behind.reached, door.behind.body) == (1, b"")


def test_a_stop_is_obeyed_though_who_asked_has_hung_up() -> None:
    door = Door()
    assert door.ask("/api/stop", VIEW, parts=(GONE,)) == 200
    assert door.behind.reached == 1
    door.ask("/api/arm", OPERATE, parts=(GONE,))
    assert door.behind.reached == 1


def test_the_page_itself_needs_no_token_but_the_right_host() -> None:
    assert Door().ask("/", OURS, "GET") == 200
    assert Door().ask("/", {"host": "evil.example"}, "GET") == 403


def test_a_page_may_load_nothing_from_elsewhere_and_stand_in_no_frame() -> None:
    policy = Door().headers("/", OURS)[b"content-security-policy"].decode()
    assert "default-src 'self'" in policy
    assert "frame-ancestors 'none'" in policy


@pytest.mark.parametrize(
    ("headers", "answer"),
    [
        (VIEW, "websocket.accept"),
        ({**OURS, "sec-websocket-protocol": "vibrostage.1, token." + TOKENS.view}, "websocket.accept"),
        ({**VIEW, "origin": "http://localhost:8787"}, "websocket.accept"),
        ({**OURS, "sec-websocket-protocol": "vibrostage.1"}, "websocket.close"),
        ({**OURS, "sec-websocket-protocol": "token.old"}, "websocket.close"),
        ({**VIEW, "origin": "http://evil.example"}, "websocket.close"),
        ({**VIEW, "host": "evil.example"}, "websocket.close"),
    ],
)
def test_an_upgrade_to_a_websocket_passes_the_same_way(headers: dict[str, str], answer: str) -> None:
    door = Door()
    assert door.connect(headers) == answer
    assert door.behind.reached == (answer == "websocket.accept")


def test_a_body_that_is_longer_than_it_says_is_cut_off() -> None:
    door = Door()
    status = door.ask("/api/arm", {**OPERATE, "content-length": "10"}, parts=(b"x" * 50_000, b"x" * 50_000))
    assert status == 413
    assert not door.behind.reached
    assert [told["status"] for told in door.told] == [413]


def test_a_body_of_just_the_largest_size_goes_through() -> None:
    door = Door()
    text = b'"' + b"x" * (LARGEST_BODY - 2) + b'"'
    assert door.ask("/api/arm", OPERATE, parts=(text,)) == 200
    assert door.behind.body == text


def test_too_many_requests_are_refused_and_a_stop_never_is() -> None:
    door = Door(rate=1.0)
    answers = [door.ask("/api/snapshot", VIEW, "GET") for _ in range(10)]
    assert answers[:2] == [200, 200]
    assert answers.count(429) >= 7
    assert [door.ask("/api/stop", OPERATE) for _ in range(5)] == [200] * 5
    assert door.ask("/api/stop", VIEW) == 200


def test_a_flood_of_refusals_does_not_flood_the_log() -> None:
    door = Door()
    for _ in range(200):
        door.ask("/api/arm", OURS)
    assert 20 <= len(door.told) <= 30
    assert {told["address"] for told in door.told} == {"127.0.0.1"}


def test_who_has_no_token_takes_no_requests_from_those_of_its_address_who_have_one() -> None:
    door = Door(rate=1.0)
    assert {door.ask("/api/snapshot", {**VIEW, "authorization": "Bearer old"}, "GET") for _ in range(50)} == {401}
    assert door.ask("/api/snapshot", VIEW, "GET") == 200
