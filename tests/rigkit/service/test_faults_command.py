"""Faults on purpose as a command: where the rig file allows it, and by whoever has control."""

from pathlib import Path

import pytest

from rigkit.faults import KINDS
from rigkit.service.client import DaemonError
from rigkit.service.control import Control
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease, Refused
from tests.rigkit.service.conftest import Bench
from tests.rigkit.service.demo_rig import DemoRig
from tests.rigkit.service.served import served


def test_they_are_refused_where_the_rig_file_does_not_allow_them(bench: Bench) -> None:
    with pytest.raises(Refused, match=r"not allowed: daemon.faults is false"):
        bench.control.inject(bench.key, "travel", "nan")


def test_they_need_control_and_are_in_the_log(tmp_path: Path) -> None:
    journal, rig = Journal(tmp_path / "events.jsonl"), DemoRig(faults=True)
    control = Control(rig, Lease(30.0), journal)
    with pytest.raises(Refused):
        control.inject("no key", "travel", "nan")
    key = control.take_control("Ada", False)["key"]
    assert control.inject(key, "travel", "nan") == {"faults": {"travel": "nan"}}
    assert journal.since(0)[-1]["event"] == "fault on purpose"
    with pytest.raises(ValueError, match="must be travel or force"):
        control.inject(key, "knee", "nan")
    assert rig.faults is not None
    assert rig.faults.present() == {"travel": "nan"}
    journal.close()


def test_the_page_is_told_what_can_be_injected_and_what_is(tmp_path: Path) -> None:
    with served(tmp_path, faults=True) as daemon, daemon.client() as client:
        rig = client.ask("GET", "/api/rig")
        assert (rig["fault_sensors"], rig["fault_kinds"]) == (["travel", "force"], list(KINDS))
        with client.control("Ada"):
            client.ask("POST", "/api/fault", {"sensor": "force", "kind": "hum"})
            with pytest.raises(DaemonError, match="kind is 'fire', must be none or stuck"):
                client.ask("POST", "/api/fault", {"sensor": "force", "kind": "fire"})
        for shown in client.watch():
            if shown["faults"] == {"force": "hum"}:
                break
