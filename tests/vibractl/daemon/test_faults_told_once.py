"""Every fault that can be put into the vibrator on purpose: what is told of it says every sentence once."""

from pathlib import Path

import pytest

from rigkit.faults import KINDS
from rigkit.service.state import State
from tests.vibractl.daemon.bench import lab_in
from vibractl.daemon import running
from vibractl.daemon.rig import Vibrator


@pytest.mark.sample(3)
@pytest.mark.parametrize("sensor", ["response_1", "loopback"])
@pytest.mark.parametrize("kind", KINDS[1:])
def test_a_recording_that_is_discarded_again_and_again_has_its_reason_told_once(
    kind: str, sensor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(running, "run_report", lambda _: None)
    lab = lab_in(tmp_path)
    lab.edit("daemon.faults=true")
    lab.control.rig = lab.rig = Vibrator(lab.rig._load)  # noqa: SLF001
    lab.control.inject(lab.key, sensor, kind)
    lab.begin(run="one", shots=2)
    lab.ended()  # looks at all that was told
    assert lab.state in (State.FAULT, State.ARMED)
    if lab.state is State.FAULT:
        (fault,) = lab.events("fault")
        assert lab.control.machine.last.why == fault["why"]
