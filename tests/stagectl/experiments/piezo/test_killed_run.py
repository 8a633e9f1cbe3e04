"""A simulated run of the stage that is killed: what was recorded is there, is reported, and comes out again."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from stagectl.application import PROGRAM
from stagectl.experiments.piezo.cell import RECORDING
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.experiments.piezo.stage_runs import recording_of, replay
from tests.until import until


@pytest.mark.slow
def test_what_was_recorded_before_a_kill_is_reported_and_replayed(tmp_path: Path) -> None:
    path, growing = tmp_path / "run", tmp_path / f"run/{RECORDING}.part.wav"
    words = ["--set", "session.lead=0.5", "--set", "session.seconds=100", "--out", str(path)]
    files = [word for file in write_models(tmp_path) for word in ("--model", str(file))]
    command = [sys.executable, "-m", "stagectl", "run", *files, *words]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
        until(lambda: (growing.exists() and os.stat(growing).st_size > 2_000_000) or program.poll() is not None)
        program.send_signal(signal.SIGKILL)
    assert program.returncode == -signal.SIGKILL
    PROGRAM.only("report")(["report", str(path)], standalone_mode=False)
    record = recording_of(path)
    assert len(record.data) * 21 * 8 > 1_900_000
    again = replay(path)
    assert len(again) == 9
    assert all(each.identical for each in again)
