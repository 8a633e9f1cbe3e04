"""Connections that ask for nothing hold nobody up, and STOP least of all."""

import json
import socket
import time
from contextlib import closing
from http.client import HTTPConnection
from pathlib import Path

import httpx
import pytest

from rigkit.service.connections import AT_ONCE, GRACE, IN_ALL, OF_ONE, Waiting
from tests.rigkit.service.served import Served, served
from tests.rigkit.service.slow_clients import slow_clients
from tests.until import EVER, until

STOPPED_WITHIN = 0.5
"""s in which a STOP is answered."""
MANY = 300


class Connection:
    def __init__(self) -> None:
        self.why = ""

    def give_up(self, status: int, why: str) -> None:
        self.why = f"{status} {why}"


def test_the_oldest_of_the_address_that_has_most_goes_for_the_newest() -> None:
    waiting, many, other = Waiting(print), [Connection() for _ in range(OF_ONE + 2)], Connection()
    waiting.add(other, "10.0.0.2", 0.0)
    for number, each in enumerate(many):
        waiting.add(each, "10.0.0.1", float(number))
    assert [bool(each.why) for each in many] == [True, True] + OF_ONE * [False]
    assert many[0].why == f"503 {OF_ONE + 1} connections of this address without a whole request, {OF_ONE} may be"
    assert not other.why
    assert len(waiting) == OF_ONE + 1


def test_each_has_a_moment_to_ask_however_many_come_at_once() -> None:
    waiting, many = Waiting(print), [Connection() for _ in range(AT_ONCE)]
    for each in many:
        waiting.add(each, "10.0.0.1", 10.0)
    assert not any(each.why for each in many)
    waiting.add(Connection(), "10.0.0.1", 10.0 + GRACE / 2)
    assert [bool(each.why) for each in many] == [True] + (AT_ONCE - 1) * [False]
    waiting.add(Connection(), "10.0.0.1", 10.0 + GRACE)
    left = OF_ONE - 2
    assert [bool(each.why) for each in many] == (AT_ONCE - left) * [True] + left * [False]


def test_from_many_addresses_there_are_not_more_in_all() -> None:
    waiting, many = Waiting(print), [Connection() for _ in range(2 * IN_ALL)]
    for number, each in enumerate(many):
        waiting.add(each, f"10.0.{number}.1", float(number))
    assert len(waiting) == IN_ALL
    assert [bool(each.why) for each in many] == IN_ALL * [True] + IN_ALL * [False]


def test_one_that_has_asked_is_out_of_it() -> None:
    waiting, asked = Waiting(print), Connection()
    waiting.add(asked, "10.0.0.1", 0.0)
    waiting.remove(asked, "10.0.0.1")
    waiting.remove(asked, "10.0.0.1")
    for number in range(OF_ONE + 1):
        waiting.add(Connection(), "10.0.0.1", float(number))
    assert not asked.why
    assert len(waiting) == OF_ONE


@pytest.mark.deadline(0.2)
def test_stop_gets_through_300_slow_connections_of_its_own_address(tmp_path: Path) -> None:
    stopped_in(tmp_path, seconds=6.0)


@pytest.mark.slow
@pytest.mark.deadline(0.2)
def test_stop_gets_through_300_slow_connections_for_a_minute(tmp_path: Path) -> None:
    stopped_in(tmp_path, seconds=60.0)


def stopped_in(folder: Path, seconds: float) -> None:
    """Stop again and again while others hold connections; each STOP is answered in time, and the log tells of them."""
    with served(folder) as daemon:
        host, port = daemon.settings.address.split(":")
        with slow_clients((host, int(port)), MANY) as slow:
            until(lambda: slow.connected == MANY)
            took = []
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                took.append(_stop(daemon))
            assert max(took) < STOPPED_WITHIN
            until(lambda: slow.cut_off > MANY)
            view = {"Authorization": f"Bearer {daemon.tokens.view}"}
            assert httpx.get(f"http://{daemon.settings.address}/api/snapshot", headers=view).status_code == 200
        told = {entry["why"] for entry in daemon.named("refused")}
        assert any("without a whole request" in why for why in told), told
        assert len(daemon.named("refused")) < 20 + 3 * seconds + 5  # the log is not flooded either


def _stop(daemon: Served) -> float:
    """Stop, over a connection of its own; return how long it took, s."""
    begin = time.monotonic()
    with closing(HTTPConnection(daemon.settings.address, timeout=60.0)) as connection:
        connection.request("POST", "/api/stop", headers={"Authorization": f"Bearer {daemon.tokens.operate}"})
        answer = connection.getresponse()
        text = answer.read()
    took = time.monotonic() - begin
    assert answer.status == 200, text
    return took


@pytest.mark.slow
def test_one_that_asks_for_nothing_goes_after_its_time_and_is_told(tmp_path: Path) -> None:
    with served(tmp_path) as daemon:
        host, port = daemon.settings.address.split(":")
        with slow_clients((host, int(port)), 4) as slow:
            until(lambda: slow.cut_off >= 4)
            until(lambda: any("no whole request within 5 s" in each["why"] for each in daemon.named("refused")))
        assert {each["status"] for each in daemon.named("refused")} <= {401, 408}


def test_what_is_no_http_is_answered_with_json_as_everything_else_is(tmp_path: Path) -> None:
    with served(tmp_path) as daemon:
        host, port = daemon.settings.address.split(":")
        with socket.create_connection((host, int(port)), timeout=EVER) as line:
            line.sendall(b"\x16\x03\x01 nonsense\r\n\r\n")
            answer = b"".join(iter(lambda: line.recv(65_536), b""))
        head, _, body = answer.partition(b"\r\n\r\n")
        assert head.startswith(b"HTTP/1.1 400 ")
        assert b"content-type: application/json" in head
        assert json.loads(body) == {"error": "Invalid HTTP request received.", "reason": "unreadable"}


@pytest.mark.slow
def test_one_that_asks_and_does_not_read_is_cut_off_and_told(tmp_path: Path) -> None:
    with served(tmp_path) as daemon:
        host, port = daemon.settings.address.split(":")
        ask = f"GET /openapi.json HTTP/1.1\r\nHost: {daemon.settings.address}\r\n\r\n".encode()
        with socket.create_connection((host, int(port)), timeout=EVER) as line:
            line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4_096)
            line.sendall(500 * ask)
            until(lambda: any("nothing read for" in each["why"] for each in daemon.named("refused")))
