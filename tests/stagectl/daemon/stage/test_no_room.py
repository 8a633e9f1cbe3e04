"""A run or a calibration of the stage for which the disk has no room does not begin: nothing moves, it stays armed."""

from pathlib import Path

import pytest

from rigkit.service.state import State
from tests.rigkit.test_disk_space import leave
from tests.stagectl.daemon.bench import lab_in


@pytest.mark.parametrize("procedure", ["follow", "hold", "calibrate"])
def test_what_the_disk_has_no_room_for_does_not_begin(
    procedure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab = lab_in(tmp_path)
    lab.control.arm(lab.key, "a test")
    leave(67.2e6, monkeypatch)
    before = sorted(path for path in lab.data.rglob("*") if path.name != "events.jsonl")
    lab.control.begin(lab.key, procedure, {"run": "one"} if procedure != "calibrate" else {"again": True}, "")
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert sorted(path for path in lab.data.rglob("*") if path.name != "events.jsonl") == before
    why = lab.events("end")[-1]["why"]
    assert "has not begun: " in why
    assert "67.2 MB are free and 67.11 MB of it stay so" in why
    lab.close()
