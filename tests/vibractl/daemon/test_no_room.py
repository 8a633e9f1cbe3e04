"""A run or a calibration for which the disk has no room does not begin: nothing is emitted, the rig stays armed."""

from pathlib import Path

import pytest

from rigkit.service.state import State
from tests.rigkit.test_disk_space import leave
from tests.vibractl.daemon.bench import Lab, lab_in
from vibractl.audio import Line

OPTIONS = {"run": {"run": "one"}, "calibrate": {"model": "found.h5"}}


def refused(lab: Lab, procedure: str, **options: object) -> str:
    """Begin it; return why it has not begun, with the rig armed and the data folder as it was."""
    before = sorted(lab.data.rglob("*"))
    lab.begin(procedure, **options)
    lab.ended()
    lab.control.journal.close()
    after = [path for path in sorted(lab.data.rglob("*")) if path.name != "events.jsonl"]
    assert after == [path for path in before if path.name != "events.jsonl"]
    assert lab.state is State.ARMED, lab.control.machine.last.why
    why: str = lab.events("end")[-1]["why"]
    return why


@pytest.mark.parametrize("procedure", OPTIONS)
def test_what_the_disk_has_no_room_for_does_not_begin(
    procedure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Line, "__enter__", lambda _: pytest.fail("the line was opened"))
    lab = lab_in(tmp_path)
    lab.control.arm(lab.key, "a test")
    leave(70e6, monkeypatch)
    why = refused(lab, procedure, **OPTIONS[procedure])
    assert "has not begun: " in why
    assert "70 MB are free and 67.11 MB of it stay so" in why


def test_a_run_that_goes_on_wants_room_for_the_shots_that_are_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab = lab_in(tmp_path)
    lab.begin("run", run="one", shots=2)
    lab.ended()
    assert lab.state is State.ARMED
    leave(67.2e6, monkeypatch)
    why = refused(lab, "run", run="one", shots=400, resume=True)
    assert "398 shots of " in why
