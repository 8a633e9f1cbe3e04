"""The robot gives way under a cut, the stage's processor reads its lasers and compensates; the host records both runs.

Guards against a compensation that works in process alone, and one whose laser, corner or prefilter is lost on the wire.
"""

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rigkit import config as rig_file
from rigkit.experiment.kept import reported, told
from stagectl.config import StageConfig
from stagectl.experiments.piezo.experiment import STAGE_RUN
from stagectl.experiments.piezo.run_setup import setup_of
from stagectl.experiments.piezo.scenario import scenario_settings
from tests.contract.source_tree import ROOT
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.experiments.piezo.stage_runs import carried_out, recording_of
from tests.until import EVER

PATIENT = "link.silence=10"
"""s: a test's machine may be busy for longer than the 20 ms of a rig."""
SECONDS = "session.seconds=5"


@pytest.mark.slow
def test_a_cut_is_compensated_by_the_stage_and_compared_over_the_wires(tmp_path: Path) -> None:
    wire, path, models = tmp_path / "wire", tmp_path / "run", write_models(tmp_path)
    settings = ["session.live=true", SECONDS, "session.recording=wav", PATIENT, "link.patience=20"]
    config = rig_file.load(None, StageConfig, [*settings, f"link.channel={wire}/can"])
    cut = scenario_settings("milling-y", config.session)
    config = rig_file.load(None, StageConfig, [*cut, *settings, f"link.channel={wire}/can"])
    command = [sys.executable, "-m", "firmware_sim", "stage", "--pty", "--milling", "y", "--folder", str(wire)]
    command += ["--set", PATIENT, "--set", SECONDS]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == f"CAN adapter: {wire}/can\n"
        try:
            reasons, figures = carried_out(path, config, models)
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(EVER) == 0
    assert figures["uncompensated_tool_error"]["y"]["mae"] > 100e-6
    assert max(each["mae"] for each in figures["tool_error"].values()) < 2e-6
    assert "position_error" not in figures  # the host does not know what the stage follows
    assert "y" in figures["prefilter"]
    record = recording_of(path)
    seen = record.select([f"absolute_{axis}" for axis in "xyz"]).data[setup_of(path).timeline.proper]
    np.testing.assert_allclose(seen.mean(axis=0), [225e-6, 375e-6, 225e-6], atol=1e-6)
    lasers = told(path, "ended")[""]["lasers"]
    assert reasons == {}
    assert lasers["axis"] == 0
    assert 0 < lasers["age"] <= 1.6e-3
    assert reported(path, STAGE_RUN)["improvement"]["y"] > 50
