"""A demonstration rig under the daemon's authority, without processes."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from rigkit.service.control import Control
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease
from rigkit.service.state import State
from tests.rigkit.service.demo_rig import DemoRig
from tests.rigkit.service.told_once import check_told_once
from tests.until import until


@dataclass
class Bench:
    """A rig, its control, and the key of whoever commands."""

    rig: DemoRig
    control: Control
    key: str

    @property
    def state(self) -> State:
        return self.control.machine.state

    def arm(self) -> None:
        self.control.arm(self.key, "to see it")

    def begin(self, name: str = "demonstrate", **options: Any) -> dict[str, Any]:
        return self.control.begin(self.key, name, options, "")

    def ended(self) -> None:
        until(lambda: not self.control.machine.busy)
        check_told_once(self.control)

    def events(self) -> list[str]:
        return [entry["event"] for entry in self.control.journal.since(0)]


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    journal = Journal(tmp_path / "events.jsonl")
    rig = DemoRig()
    control = Control(rig, Lease(1e6), journal)
    yield Bench(rig, control, control.take_control("Ada", False)["key"])
    control.close(10.0)
    journal.close()
