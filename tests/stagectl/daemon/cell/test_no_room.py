"""A procedure of the cell for which the disk has no room does not begin: nothing moves, and it stays armed."""

from pathlib import Path
from typing import Any

import pytest

from rigkit.service.state import State
from tests.rigkit.test_disk_space import leave
from tests.stagectl.daemon.cell.bench import cell_in
from tests.stagectl.experiments.feed.small_pocket import QUICK
from tests.stagectl.experiments.toroid.short_cell import SHORT

SETTINGS = {"calibrate-milling": ["pocket.feed=6e-3"]}
OPTIONS: dict[str, dict[str, Any]] = {
    "ilc": {"run": "one"},
    "force": {"run": "one", "task": "slot"},
    "cell": {"run": "one", "setup": "B"},
    "midrange": {"run": "one", "scenario": "toroid"},
    "step": {"run": "one", "period": 600.0, "repeats": 100},
    "calibrate-milling": {"model": "found.h5"},
    "calibrate-joints": {"model": "found.h5", "joints": "1"},
}


@pytest.mark.parametrize("procedure", OPTIONS)
def test_what_the_disk_has_no_room_for_does_not_begin(
    procedure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab = cell_in(tmp_path, *QUICK, *SHORT, *SETTINGS.get(procedure, ()))
    lab.control.arm(lab.key, "a test")
    leave(67.12e6, monkeypatch)
    before = sorted(path for path in lab.data.rglob("*") if path.name != "events.jsonl")
    lab.control.begin(lab.key, procedure, OPTIONS[procedure], "")
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert sorted(path for path in lab.data.rglob("*") if path.name != "events.jsonl") == before
    why = lab.events("end")[-1]["why"]
    assert "has not begun: " in why
    assert "67.12 MB are free and 67.11 MB of it stay so" in why
    lab.close()
