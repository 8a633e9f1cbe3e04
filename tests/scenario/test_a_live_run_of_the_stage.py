"""The program reaches the stage over its wire only: loops are uploaded, references streamed, positions recorded.

Guards against a live run that works in process alone, and one whose folder cannot be reported afterwards.
"""

import signal
import subprocess
import sys
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from rigkit import config as rig_file
from rigkit.growing_wav import GROWING
from rigkit.run_folder import read_events
from rigkit.stream_recorder import StreamRecorder
from stagectl.__main__ import main
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import RECORDING
from stagectl.experiments.piezo.run_setup import setup_of
from stagectl.link.stage_link import StageLink
from tests.contract.source_tree import ROOT
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.experiments.piezo.stage_runs import carried_out, recording_of, replay
from tests.until import EVER

PATIENT = "link.silence=10"
"""s: a test's machine may be busy for longer than the 20 ms of a rig."""
SOME = 1_500_000
"""Bytes of a recording that is killed: a second and a half."""
COMMAND = [sys.executable, "-m", "firmware_sim", "stage", "--pty", "--set", PATIENT, "--folder"]


@pytest.mark.slow
def test_a_live_run_uploads_its_loops_follows_and_can_be_reported_but_not_replayed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    order: list[str] = []
    stop, close = StageLink.stop, StreamRecorder.close
    monkeypatch.setattr(StageLink, "stop", lambda link: (order.append("stop"), stop(link)))
    monkeypatch.setattr(StreamRecorder, "close", lambda made: (order.append("keep"), close(made)))
    wire, path, models = tmp_path / "wire", tmp_path / "run", write_models(tmp_path)
    settings = ["session.live=true", "session.seconds=0.5", "session.recording=wav", "outer.mistuning=0.0", PATIENT]
    config = rig_file.load(None, StageConfig, [*settings, f"link.channel={wire}/can", "link.patience=20"])
    with subprocess.Popen([*COMMAND, str(wire)], cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == f"CAN adapter: {wire}/can\n"
        try:
            reasons, figures = carried_out(path, config, models)
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(EVER) == 0
    assert (reasons, figures["seconds"]) == ({}, 0.5)
    assert "tool_error" not in figures
    assert order == ["stop", "keep"]  # else the stage waits for references while the recording is written
    assert {"started", "uploaded", "ended"} <= {event["event"] for event in read_events(path)}
    record = recording_of(path)
    position = record.select([f"position_{axis}" for axis in "xyz"]).data[setup_of(path).timeline.proper]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), 225e-6, atol=0.5e-6)
    assert (path / "report.html").is_file()
    with pytest.raises(ValueError, match="nothing to replay here"):
        replay(path)


@pytest.mark.slow
def test_a_live_run_that_is_killed_can_be_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All that was on the disk is there, until the last 50 ms."""
    wire, models, run = tmp_path / "wire", write_models(tmp_path), tmp_path / "run"
    settings = ["session.seconds=60", "session.recording=csv", "outer.mistuning=0.0", PATIENT, "link.patience=20"]
    command = [sys.executable, "-m", "stagectl", "run", "--live", "--out", str(run)]
    for text in (*settings, f"link.channel={wire}/can"):
        command += ["--set", text]
    for model in models:
        command += ["--model", str(model)]
    with subprocess.Popen([*COMMAND, str(wire)], cwd=ROOT, stdout=subprocess.PIPE, text=True) as bench:
        assert bench.stdout is not None
        assert bench.stdout.readline() == f"CAN adapter: {wire}/can\n"
        try:
            with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.DEVNULL) as process:
                growing = run / f"{RECORDING}{GROWING}"
                while process.poll() is None and (not growing.exists() or growing.stat().st_size < SOME):
                    Event().wait(0.02)
                process.kill()
                size = growing.stat().st_size
        finally:
            bench.send_signal(signal.SIGINT)
            assert bench.wait(EVER) == 0
    monkeypatch.setattr("sys.argv", ["stagectl", "report", str(run)])
    assert main() == 0
    record = recording_of(run)
    assert size - 4_000 < record.data.nbytes <= size
    np.testing.assert_allclose(record.data[-1_000:, 3:6].mean(axis=0), 225e-6, atol=2e-6)
    assert not growing.exists()
