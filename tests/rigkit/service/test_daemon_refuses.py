"""Who is kept out of a daemon that runs: each is refused, it is in the log, and nothing has changed."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from rigkit.service import answers
from rigkit.service.gate import STREAM, TOKEN
from rigkit.service.stream import WINDOW
from tests.rigkit.service.described import is_described
from tests.rigkit.service.served import Served, base, operating, served
from tests.until import EVER, until


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("lab")
    with served(folder, requests=1000.0, clients=3) as made:
        (folder / "runs" / "one").mkdir()
        (folder / "runs" / "one" / "report.html").write_text("<p>learned</p>")
        (folder / "runs" / "one" / "secret").symlink_to(folder / "token")
        yield made


@pytest.mark.parametrize(
    ("headers", "status", "why"),
    [
        ({"Host": "evil.example"}, 403, "the host 'evil.example' is not one of"),
        ({"Origin": "http://evil.example"}, 403, "the origin 'http://evil.example' is not"),
        ({"Authorization": ""}, 401, "there is no token"),
        ({"Authorization": "Bearer " + "old" * 14}, 401, "the token is not this daemon's"),
        ({"Authorization": "view"}, 403, "this token may view"),
    ],
)
def test_a_request_that_may_not_is_refused_and_told(
    daemon: Served, headers: dict[str, str], status: int, why: str
) -> None:
    if headers.get("Authorization") == "view":
        headers = {"Authorization": f"Bearer {daemon.tokens.view}"}
    before = len(daemon.named("refused"))
    answer = httpx.post(f"{base(daemon)}/api/control", json={"who": "Eve"}, headers={**operating(daemon), **headers})
    assert answer.status_code == status
    assert why in answer.json()["error"]
    until(lambda: len(daemon.named("refused")) > before)
    until(lambda: why in daemon.newest("refused", "why"))
    assert daemon.named("control") == []


def fetched(daemon: Served, path: str) -> tuple[int, str]:
    """Ask for a path as it stands, which clients with good manners would tidy up first."""
    line = HTTPConnection(daemon.settings.address, timeout=EVER)
    line.request("GET", path, headers=operating(daemon))
    answer = line.getresponse()
    status, text = answer.status, answer.read().decode()
    line.close()
    return status, text


@pytest.mark.parametrize(
    "path",
    [
        "../token",
        "%2e%2e/token",
        "one/../../token",
        "one/%2e%2e/%2e%2e/token",
        "one/secret",
        "one//etc/passwd",
        ".lock",
    ],
)
def test_no_path_leads_out_of_the_runs(daemon: Served, path: str) -> None:
    before = len(daemon.named("refused"))
    status, text = fetched(daemon, f"/api/runs/{path}")
    assert status == 403
    assert daemon.tokens.operate not in text
    until(lambda: len(daemon.named("refused")) > before)
    until(lambda: "leads out of the data folder" in daemon.newest("refused", "why"))


def test_no_path_leads_out_of_the_page(daemon: Served) -> None:
    for path in ("/../config.py", "/%2e%2e/config.py", "//etc/passwd", "/api/runs//etc/passwd", "/api/../../config.py"):
        assert fetched(daemon, path)[0] == 404


def test_a_file_of_a_run_is_given(daemon: Served) -> None:
    answer = httpx.get(f"{base(daemon)}/api/runs/one/report.html", headers=operating(daemon))
    assert (answer.status_code, answer.text) == (200, "<p>learned</p>")
    assert answer.headers["content-disposition"] == 'attachment; filename="report.html"'
    with daemon.client() as client:
        assert [run["name"] for run in client.ask("GET", "/api/runs")] == ["one"]
        listed = client.ask("GET", "/api/runs/one")
    is_described(list[answers.File], listed)
    assert [(file["path"], file["size"]) for file in listed] == [("report.html", 14)]


@pytest.mark.parametrize(("path", "why"), [("two", "there is no run 'two'"), ("one/x", "there is no file 'x' in")])
def test_what_is_not_among_the_runs_is_missed_by_name(daemon: Served, path: str, why: str) -> None:
    answer = httpx.get(f"{base(daemon)}/api/runs/{path}", headers=operating(daemon))
    assert answer.status_code == 404
    assert why in answer.json()["error"]


@pytest.mark.parametrize(
    ("body", "status"),
    [
        (b"{}", 422),
        (b'{"who": ""}', 422),
        (b'{"who": "Ada\\n"}', 422),
        (b'{"who": 3}', 422),
        (b'{"who": "Ada", "extra": 1}', 422),
        (b"not JSON", 400),
        (b"[" * 50_000, 400),
        (b"x" * 100_000, 413),
    ],
)
def test_a_body_that_is_not_as_it_must_be_is_refused_in_one_line(daemon: Served, body: bytes, status: int) -> None:
    headers = {**operating(daemon), "Content-Type": "application/json"}
    answer = httpx.post(f"{base(daemon)}/api/control", content=body, headers=headers)
    assert answer.status_code == status, answer.text
    assert "\n" not in answer.json()["error"]


def test_a_megabyte_that_does_not_say_how_long_it_is_is_cut_off_and_told(daemon: Served) -> None:
    before = len(daemon.named("refused"))
    parts = iter([b"x" * 10_000] * 100)
    answer = httpx.post(f"{base(daemon)}/api/control", content=parts, headers=operating(daemon))
    assert (answer.status_code, answer.json()["error"]) == (413, "a request of more than 65536 bytes")
    until(lambda: len(daemon.named("refused")) > before)
    until(lambda: daemon.newest("refused", "status") == 413)


def test_another_method_is_refused_with_those_that_there_are(daemon: Served) -> None:
    there_are = {"/api/arm": "POST", "/api/rig": "GET", "/api/control": "DELETE, POST, PUT", "/": "GET, HEAD"}
    for path, there in there_are.items():
        answer = httpx.patch(f"{base(daemon)}{path}", headers=operating(daemon))
        assert (answer.status_code, answer.headers["allow"]) == (405, there)
        assert answer.json() == {"error": "Method Not Allowed", "reason": "method"}


def test_a_command_without_control_is_refused(daemon: Served) -> None:
    answer = httpx.post(f"{base(daemon)}/api/arm", json={"why": "x"}, headers=operating(daemon))
    assert (answer.status_code, answer.json()["error"]) == (403, "nobody has control; take control first")


def stream(daemon: Served, **more: Any) -> ClientConnection:
    wanted = {"subprotocols": [STREAM, TOKEN + daemon.tokens.view], "compression": None} | more
    return connect(f"ws://{daemon.settings.address}/api/stream", **wanted)


def drained(line: ClientConnection) -> list[str]:
    """Return what comes until the daemon closes, which it must within 20 s of silence."""
    received = []
    try:
        while True:
            received.append(str(line.recv(timeout=EVER)))
    except ConnectionClosed:
        return received


@pytest.mark.parametrize(
    "more",
    [
        {"origin": "http://evil.example"},
        {"subprotocols": [STREAM]},
        {"subprotocols": [STREAM, TOKEN + "old"]},
    ],
)
def test_a_websocket_that_may_not_is_refused_before_it_is_one(daemon: Served, more: dict[str, Any]) -> None:
    before = len(daemon.named("refused"))
    with pytest.raises(InvalidStatus) as refused:
        stream(daemon, **more)
    assert refused.value.response.status_code == 403
    until(lambda: len(daemon.named("refused")) > before)
    until(lambda: daemon.newest("refused", "path") == "/api/stream")


def test_there_is_one_stream_and_no_other(daemon: Served) -> None:
    with pytest.raises(InvalidStatus) as refused:
        connect(f"ws://{daemon.settings.address}/api/other", additional_headers=operating(daemon))
    assert refused.value.response.status_code == 403


def test_a_websocket_under_another_name_is_refused(daemon: Served) -> None:
    before = len(daemon.named("refused"))
    host, port = daemon.settings.address.split(":")
    offered: Any = [STREAM, TOKEN + daemon.tokens.view]
    with socket.create_connection((host, int(port))) as line, pytest.raises(InvalidStatus) as refused:
        connect(f"ws://evil.example:{port}/api/stream", subprotocols=offered, sock=line)
    assert refused.value.response.status_code == 403
    until(lambda: len(daemon.named("refused")) > before)
    until(lambda: "the host 'evil.example" in daemon.newest("refused", "why"))


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ("1" * 1_000_000, "frame with 1000000 bytes exceeds limit of 1024 bytes"),
        ("999999999", "it says '999999999', which is not the tick of a snapshot sent to it"),
        ("a tick", "it says 'a tick', which is not the tick of a snapshot sent to it"),
        (b"1", "it sends bytes, must be text"),
    ],
)
def test_one_that_does_not_speak_as_it_must_is_closed_and_told(daemon: Served, said: str | bytes, why: str) -> None:
    before = len(daemon.named("dropped"))
    with stream(daemon) as line:
        line.recv(timeout=EVER)
        line.send(said)
        drained(line)
    until(lambda: len(daemon.named("dropped")) > before)
    until(lambda: daemon.newest("dropped", "why") == why)


def test_one_that_does_not_say_that_it_reads_gets_a_few_snapshots_and_is_closed(daemon: Served) -> None:
    before = len(daemon.named("dropped"))
    with stream(daemon) as line:
        assert len(drained(line)) <= WINDOW
    until(lambda: len(daemon.named("dropped")) > before)
    until(lambda: daemon.newest("dropped", "why") == "it has not read a snapshot for 1.5 s")


def test_more_than_may_watch_are_sent_away_and_the_others_go_on(daemon: Served) -> None:
    with ExitStack() as opened:
        watching = [opened.enter_context(stream(daemon)) for _ in range(3)]
        with pytest.raises(InvalidStatus):
            stream(daemon)
        assert all(each.recv(timeout=EVER) for each in watching)
    until(lambda: "3 watch already (daemon.clients)" in [entry["why"] for entry in daemon.named("dropped")])


def test_nothing_of_all_this_has_changed_the_rig(daemon: Served) -> None:
    with daemon.client() as client:
        shown = client.snapshot()
    assert (shown["state"]["name"], shown["control"]) == ("DISARMED", None)


def test_the_description_of_the_api_is_published_and_names_every_way_in(daemon: Served) -> None:
    described = httpx.get(f"{base(daemon)}/openapi.json").json()
    assert {"/api/stop", "/api/arm", "/api/begin", "/api/panels/{name}", "/metrics"} <= described["paths"].keys()


def test_the_description_says_of_every_way_in_what_it_answers_how_it_refuses_and_that_it_wants_a_token(
    daemon: Served,
) -> None:
    described = httpx.get(f"{base(daemon)}/openapi.json").json()
    operations = [operation for path in described["paths"].values() for operation in path.values()]
    assert len(operations) >= 20
    for operation in operations:
        (content,) = operation["responses"]["200"]["content"].values()
        assert content["schema"], operation["operationId"]
        for status in ("401", "403", "422", "429", "500", "503"):
            refusal = operation["responses"][status]["content"]["application/json"]["schema"]
            assert refusal == {"$ref": "#/components/schemas/Error"}
        assert operation["security"] == [{"HTTPBearer": []}]
    assert described["components"]["securitySchemes"]["HTTPBearer"]["scheme"] == "bearer"


@pytest.mark.slow
def test_a_second_daemon_on_the_same_data_or_address_is_refused_in_one_line(daemon: Served, tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match="is in use by process"), served(Path(daemon.settings.data)):
        pass
    with (
        pytest.raises(AssertionError, match=r"daemon at port \d+ is in use by process"),
        served(tmp_path, address=daemon.settings.address),
    ):
        pass
