"""JSON that comes over the network is read as what it says, or refused."""

from collections.abc import Iterator

import httpx
import pytest

from tests.rigkit.service.served import Served, base, operating, served


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("lab"), requests=1000.0) as made:
        yield made


ODD: dict[str, bytes] = {
    "half a character": b'{"who": "Ada", "over": "\\ud800"}',
    "half a character in a key": b'{"\\udfff": 1}',
    "nesting": b'{"who": ' + b"[" * 30_000 + b"]" * 30_000 + b"}",
    "a number of thousands of digits": b'{"who": ' + b"1" * 6_000 + b"}",
    "a number beyond 64 bits": b'{"who": 99999999999999999999}',
    "NaN": b'{"who": NaN}',
    "an infinity": b'{"who": 1e999}',
    "a key twice": b'{"who": "Ada", "who": "Eve"}',
    "no UTF-8": b'{"who": "\xff"}',
    "no JSON": b"who=Ada",
}


@pytest.mark.sample(8)
@pytest.mark.parametrize("body", ODD.values(), ids=ODD)
@pytest.mark.parametrize("path", ["control", "begin", "fault", "arm", "hold", "acknowledge", "reload"])
def test_json_that_can_be_read_in_two_ways_or_in_none_is_refused_by_every_command(
    daemon: Served, path: str, body: bytes
) -> None:
    headers = {**operating(daemon), "Content-Type": "application/json"}
    answer = httpx.post(f"{base(daemon)}/api/{path}", content=body, headers=headers)
    assert answer.status_code == 400, answer.text
    assert set(answer.json()) == {"error", "reason"}
    assert answer.json()["error"].startswith("the request: ")


def test_half_a_character_in_an_option_of_a_procedure_is_refused(daemon: Served) -> None:
    body = b'{"procedure": "demonstrate", "options": {"steps": "\\ud800"}}'
    headers = {**operating(daemon), "Content-Type": "application/json"}
    answer = httpx.post(f"{base(daemon)}/api/begin", content=body, headers=headers)
    assert answer.status_code == 400
    assert 'options.steps is "\\ud800", holds half a character' in answer.json()["error"]
