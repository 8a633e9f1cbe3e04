"""Sensors of the stage that fail on purpose: what is told of it says every sentence once."""

from pathlib import Path

import pytest

from rigkit.service.state import State
from tests.stagectl.daemon.bench import lab_in


@pytest.mark.parametrize("sensor", ["position_y", "extension_y"])
def test_whatever_a_sensor_says_its_reason_is_told_once(
    sensor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("stagectl.experiments.piezo.experiment.run_report", lambda *_: None)
    lab = lab_in(tmp_path, "daemon.faults=true")
    faults = 0
    for kind in ("stuck", "nan", "inf", "zero", "full-scale"):
        lab.control.inject(lab.key, sensor, kind)
        lab.begin("hold", run=kind, seconds=0.1)
        lab.ended()  # looks at all that was told
        assert lab.state in (State.FAULT, State.ARMED)
        if lab.state is State.FAULT:
            faults += 1
            assert lab.events("fault")[-1]["why"] == lab.why
            lab.control.acknowledge(lab.key, "it was on purpose")
    assert faults >= 3
    lab.close()
