"""The daemon has a stage behind its link follow with its lasers: the tool stays while the robot gives way under a cut.

Guards against a daemon that compensates what is simulated alone, and gauges that show the plate for the tool.
"""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from rigkit.service.state import State
from tests.contract.source_tree import ROOT
from tests.stagectl.daemon.bench import Lab, lab_in
from tests.stagectl.experiments.piezo.stage_runs import recording_of
from tests.until import EVER, until

PATIENT = "link.silence=10"
"""s: a test's machine may be busy for longer than the 20 ms of a rig."""
SECONDS = "session.seconds=5"


@pytest.mark.slow
def test_a_cut_is_compensated_by_the_stage_and_seen_by_its_lasers(tmp_path: Path) -> None:
    wire = tmp_path / "wire"
    command = [sys.executable, "-m", "firmware_sim", "stage", "--pty", "--milling", "y", "--folder", str(wire)]
    with subprocess.Popen(
        [*command, "--set", PATIENT, "--set", SECONDS], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == f"CAN adapter: {wire}/can\n"
        place = "reference.position=[225e-6, 375e-6, 225e-6]"
        lab = lab_in(
            tmp_path, "session.live=true", SECONDS, PATIENT, place, f"link.channel={wire}/can", "link.patience=20"
        )
        try:
            lab.begin(reference="hold", deflection=True)
            lab.until_follows()
            until(lambda: abs(value(lab, "deflection_y")) > 50e-6 or not lab.control.machine.busy)
            assert abs(value(lab, "deflection_y")) > 50e-6, lab.why
            assert abs(value(lab, "absolute_y") - 375e-6) < 20e-6
            lab.ended()
            assert lab.state is State.ARMED, lab.why
        finally:
            lab.close()
            process.send_signal(signal.SIGINT)
            assert process.wait(EVER) == 0
    figures = json.loads((lab.run_folder() / "summary.json").read_text())
    assert max(each["mae"] for each in figures["tool_error"].values()) < 5e-6
    assert "position_error" not in figures
    assert "absolute_y" in recording_of(lab.run_folder()).names
    assert set(lab.control.board.revisions()) == {"histogram", "spectrum"}


def value(lab: Lab, name: str) -> float:
    """Return a gauge's value; 0 once the run is over."""
    return next((gauge.value or 0.0 for gauge in lab.rig.gauges() if gauge.name == name), 0.0)
