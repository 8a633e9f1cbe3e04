"""The daemon is killed while the stage follows: what was recorded is whole, and it comes back DISARMED."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from rigkit import config as rig_file
from rigkit.growing_wav import GROWING
from stagectl.__main__ import main
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import RECORDING
from tests.rigkit.service.served import ROOT, Served, answering, free_port
from tests.stagectl.daemon.bench import lab_in
from tests.stagectl.experiments.piezo.stage_runs import recording_of
from tests.until import until

SOME = 1_500_000
"""Bytes of a recording that is killed: nearly a second."""


@contextmanager
def daemon_of(file: Path) -> Iterator[Served]:
    """Start `stagectl daemon`, and see that it is gone afterwards."""
    command = [sys.executable, "-m", "stagectl", "daemon", "--config", str(file)]
    process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    with answering(Served(rig_file.load(file, StageConfig).daemon, process), ready=100) as made:
        yield made


@pytest.mark.slow
def test_a_daemon_killed_while_the_stage_follows_leaves_a_whole_recording_and_comes_back_disarmed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lab = lab_in(tmp_path, f"daemon.address=127.0.0.1:{free_port()}")
    lab.close()

    def stagectl(*words: str) -> int:
        monkeypatch.setattr(sys, "argv", ["stagectl", *words])
        return main()

    growing = lab.run_folder() / f"{RECORDING}{GROWING}"
    with daemon_of(lab.file) as daemon:
        with daemon.client() as client, client.control("Ada"):
            client.command("arm", "a test")
            client.begin("hold", run="one", seconds=100.0)
        until(lambda: growing.exists() and growing.stat().st_size > SOME)
        assert stagectl("status", "--config", str(lab.file)) == 0
        assert "RUNNING" in capsys.readouterr().out
        daemon.process.kill()
        daemon.process.wait()
        size = growing.stat().st_size
    assert stagectl("report", str(lab.run_folder())) == 0
    record = recording_of(lab.run_folder())
    assert size - 4_000 < record.data.nbytes <= size
    np.testing.assert_allclose(record.select(["position_x"]).data[-500:], 225e-6, atol=2e-6)
    with daemon_of(lab.file) as daemon:
        with daemon.client() as client:
            assert client.snapshot()["state"]["name"] == "DISARMED"
        assert stagectl("stop", "--config", str(lab.file)) == 0
        assert "stopped: DISARMED -> DISARMED" in capsys.readouterr().out
