"""What is answered when a procedure is begun: that it has begun, or why it has not."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from rigkit.service import answers
from rigkit.service.client import DaemonError
from tests.rigkit.service.described import is_described
from tests.rigkit.service.served import Served, base, operating, served
from tests.until import until


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("lab"), requests=1000.0) as made:
        yield made


def test_a_procedure_that_is_refused_while_it_is_made_is_no_success_and_leaves_the_panels(tmp_path: Path) -> None:
    with served(tmp_path) as daemon, daemon.client() as client, client.control("Ada"):
        client.command("arm", "a test")
        assert client.begin("demonstrate", steps=1, seconds=0.0)["state"] == "RUNNING"
        until(lambda: client.snapshot()["state"]["name"] == "ARMED" and client.snapshot()["panels"])
        before = client.snapshot()["panels"]
        with pytest.raises(DaemonError, match="model is 'x.h5', must be nothing") as refused:
            client.begin("demonstrate", model="x.h5")
        assert refused.value.status == 422
        headers = {**operating(daemon), "X-Control": client._key}  # noqa: SLF001
        asked = {"procedure": "demonstrate", "options": {"model": "x.h5"}}
        answer = httpx.post(f"{base(daemon)}/api/begin", json=asked, headers=headers)
        assert (answer.status_code, answer.json()["reason"]) == (422, "not_begun")
        is_described(answers.Error, answer.json())
        until(lambda: client.snapshot()["state"]["name"] == "ARMED")
        assert client.snapshot()["panels"] == before
        assert client.panel("lines")["title"] == "Worst lines"
        assert client.begin("demonstrate", steps=1, seconds=0.0)["state"] == "RUNNING"
        until(lambda: client.snapshot()["panels"] != before)


def test_a_begin_that_the_state_does_not_allow_says_so_for_programs_too(daemon: Served) -> None:
    with daemon.client() as client, client.control("Ada", over=True):
        headers = {**operating(daemon), "X-Control": client._key}  # noqa: SLF001
        answer = httpx.post(f"{base(daemon)}/api/begin", json={"procedure": "demonstrate"}, headers=headers)
    assert (answer.status_code, answer.json()["reason"]) == (409, "wrong_state")
