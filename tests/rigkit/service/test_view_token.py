"""What the token to view may do with a daemon that runs: look, and STOP."""

from collections.abc import Iterator

import httpx
import pytest
from websockets.sync.client import connect

from rigkit.service.client import Client, DaemonError
from rigkit.service.gate import STREAM, TOKEN
from tests.rigkit.service.served import Served, base, served
from tests.until import until


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("lab")
    with served(folder, requests=1000.0) as made:
        (folder / "runs" / "one").mkdir()
        (folder / "runs" / "one" / "report.html").write_text("<p>learned</p>")
        yield made


def test_the_token_to_view_looks_and_stops_and_is_refused_all_else(daemon: Served) -> None:
    view = {"Authorization": f"Bearer {daemon.tokens.view}"}
    found: dict[str, set[int]] = {"looked": set(), "commanded": set(), "stopped": set()}
    for path, ways in httpx.get(f"{base(daemon)}/openapi.json").json()["paths"].items():
        asked = path.format(name="none", run="one", path="report.html")
        for method in ways:
            kind = "looked" if method == "get" else "stopped" if path == "/api/stop" else "commanded"
            answer = httpx.request(method, f"{base(daemon)}{asked}", headers=view)
            found[kind].add(answer.status_code)
            if kind == "commanded":
                assert answer.json()["error"].startswith("this token may view and STOP"), (method, path)
    assert found["looked"] <= {200, 404}
    assert (found["commanded"], found["stopped"]) == ({403}, {200})
    until(lambda: daemon.newest("stop", "who") == "somebody")
    daemon.begin(steps=100_000, seconds=0.02)
    with Client(daemon.settings.address, daemon.tokens.view) as client:
        told = client.stop("Eve", "smoke")
        assert (told["before"], told["state"]) == ("RUNNING", "DISARMED")
        with pytest.raises(DaemonError, match="this token may view and STOP"), client.control("Eve"):
            pass
        until(lambda: daemon.newest("stop", "why") == "smoke")
        for _ in range(20):
            assert client.stop("Eve", "held down")["state"] == "DISARMED"
    until(lambda: daemon.named("stop")[-1].get("times") == 21)
    assert daemon.named("stop")[-1]["asker"] == "view at 127.0.0.1"
    assert {entry["who"] for entry in daemon.named("control")} == {"Ada"}


@pytest.mark.parametrize(
    ("body", "who", "why"),
    [
        (b"no JSON", "somebody", "stopped"),
        (b"\xff\xfe", "somebody", "stopped"),
        (b"[" * 200_000, "somebody", "stopped"),
        (b'{"why": "' + b"x" * 70_000 + b'"}', "somebody", "stopped"),
        (b'["smoke"]', "somebody", "stopped"),
        (b'{"who": 7, "why": {"a": "b"}, "where": "there"}', "somebody", "stopped"),
        (b'{"who": "Eve", "why": "' + b"x" * 300 + b'"}', "Eve", "x" * 200),
        (b'{"who": "E\\ud800ve", "why": "sm\\u0000oke"}', "E?ve", "sm?oke"),
        (b'{"who": "  ", "why": ""}', "somebody", "stopped"),
    ],
)
def test_a_stop_is_obeyed_whatever_its_words(daemon: Served, body: bytes, who: str, why: str) -> None:
    daemon.begin(steps=100_000, seconds=0.02)
    stops = len(daemon.named("stop"))
    view = {"Authorization": f"Bearer {daemon.tokens.view}", "Host": "10.0.0.5"}
    answer = httpx.post(f"{base(daemon)}/api/stop", content=body, headers=view)
    assert (answer.status_code, answer.json()["before"], answer.json()["state"]) == (200, "RUNNING", "DISARMED")
    until(lambda: len(daemon.named("stop")) > stops)
    assert (daemon.newest("stop", "who"), daemon.newest("stop", "why")) == (who, why)


def test_the_description_says_that_any_token_may_stop(daemon: Served) -> None:
    paths = httpx.get(f"{base(daemon)}/openapi.json").json()["paths"]
    assert "Any token may, the one to view as well" in paths["/api/stop"]["post"]["description"]


@pytest.mark.parametrize("token", ["view", "operate"])
def test_the_stream_takes_no_commands_whatever_the_token(daemon: Served, token: str) -> None:
    address = f"ws://{daemon.settings.address}/api/stream"
    with connect(address, subprotocols=[STREAM, TOKEN + getattr(daemon.tokens, token)], compression=None) as socket:  # type: ignore[list-item]
        assert socket.recv()
        dropped = len(daemon.named("dropped"))
        socket.send("stop")
        until(lambda: len(daemon.named("dropped")) > dropped)
    until(lambda: "it says 'stop', which is not the tick" in daemon.newest("dropped", "why"))
