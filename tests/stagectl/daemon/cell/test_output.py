"""Each procedure of the cell's daemon shows what it puts out while it runs, simulated and live."""

import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from firmware_sim.stage_processor import Settings
from rigkit import config as rig_file
from rigkit.service.snapshot import snapshot
from stagectl.daemon.cell.rig import RobotCell
from stagectl.experiments.toroid.experiment import Toroid
from stagectl.robot.config import CellConfig
from tests.rigkit.service.outputs import is_measured_while_it_runs
from tests.scenario.stepped_cell import BUSY, SteppedCell
from tests.scenario.test_joints_in_a_clamp_over_the_wires import QUICK as QUICK_JOINTS
from tests.scenario.test_mid_ranging_over_both_wires import MIDRANGING
from tests.scenario.test_the_toroid_over_the_wires import SETTINGS as TOROID_SETTINGS
from tests.stagectl.daemon.bench import Lab, lab_of
from tests.stagectl.daemon.cell.bench import cell_in
from tests.stagectl.experiments.feed.small_pocket import QUICK
from tests.stagectl.experiments.feed.test_command import POCKET
from tests.stagectl.experiments.toroid.short_cell import SHORT
from tests.stagectl.link.stand_in import PATIENT, link_to, running
from tests.until import until

OPTIONS: dict[str, dict[str, Any]] = {
    "ilc": {"run": "one", "task": "pocket", "iterations": 1},
    "force": {"run": "one", "task": "small.json", "pockets": 2},
    "cell": {"run": "one", "setup": "A"},
    "midrange": {"run": "one", "scenario": "wave.csv", "controller": "mvpc"},
    "step": {"run": "one", "of": "stage", "size": 1e-4, "repeats": 100},
    "calibrate-milling": {"task": "pocket28", "model": "found.h5"},
    "calibrate-joints": {"joints": "3"},
}
LIVE = {
    "midrange": {"midranging": MIDRANGING},
    "step": {"midranging": MIDRANGING},
    "calibrate-joints": {"clamping": QUICK_JOINTS},
    "cell": TOROID_SETTINGS | {"toroid": {"turn": 1.0}},
}
"""Procedures that lead a robot over its wires, where the cell's file or their options say so."""
OF_LIVE = {"cell": {"setup": "B", "live": True}}
PANELS = {"midrange": {"position", "manipulators", "control"}, "step": {"robot", "stage", "control"}}
"""Of those that lead the stage as well."""


LONG_ENOUGH = "pocket.feed=5e-3"
"""m/s along the pocket's path, for models of milling to be calibrated on it."""


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    made = cell_in(tmp_path, *QUICK, *SHORT, "midranging.session.lead=0.2", LONG_ENOUGH)
    (made.data / "small.json").write_text(json.dumps(POCKET))
    _write_wave(made.data, 1e-3, 25_000)
    yield made
    made.close()


def _write_wave(data: Path, amplitude: float, samples: int) -> None:
    wanted = amplitude * np.sin(2 * np.pi * np.arange(samples) / 250)[:, None]
    recording.write(data / "wave.csv", Recording(("x",), ("m",), 250.0, wanted))


@pytest.mark.sample(1)
@pytest.mark.parametrize("procedure", OPTIONS)
def test_the_output_of_a_simulation_is_measured_while_a_procedure_runs(lab: Lab, procedure: str) -> None:
    assert {each.name for each in lab.rig.procedures} == OPTIONS.keys()
    lab.control.arm(lab.key, "a test")
    assert snapshot(lab.control, 1, 0, 0.0)["output"] == "unknown"
    lab.control.begin(lab.key, procedure, OPTIONS[procedure], "")
    assert is_measured_while_it_runs(lab.control)
    names = [gauge.name for gauge in lab.rig.gauges()]
    assert len(set(names)) == len(names)
    lab.control.stop("Ada", "seen")
    lab.ended()


@pytest.mark.slow
@pytest.mark.stall(0.3)
@pytest.mark.parametrize("procedure", LIVE)
def test_the_output_of_a_live_robot_is_measured_while_it_is_led(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, procedure: str
) -> None:
    data, file, wire = tmp_path / "data", tmp_path / "cell.toml", tmp_path / "can"
    (data / "runs").mkdir(parents=True)
    _write_wave(data, 50e-6, 2_500)
    with (
        running(wire, Settings(silence=PATIENT, pace="host")),
        SteppedCell(**LIVE[procedure]) as stepped,
    ):
        # the stepped robot's clock goes faster than ours, and two ports lead it one after the other
        monkeypatch.setattr("stagectl.experiments.toroid.daemon.Toroid", partial(Toroid, now=stepped.now))
        link, daemon = link_to(wire, silence=PATIENT, patience=BUSY), stepped.config.daemon
        changed = {"link": link, "daemon": daemon.model_copy(update={"data": str(data)})}
        file.write_text(rig_file.dump(stepped.config.model_copy(update=changed)))
        lab = lab_of(RobotCell(lambda: rig_file.load(file, CellConfig)), file, data)
        lab.control.arm(lab.key, "a test")
        lab.control.begin(lab.key, procedure, OPTIONS[procedure] | OF_LIVE.get(procedure, {}), "")
        assert is_measured_while_it_runs(lab.control)
        if procedure in PANELS:
            until(lambda: lab.gauge("led").value == 1.0)
            assert {gauge.name for gauge in lab.rig.gauges() if gauge.is_output} == {"tool_speed", "led"}
            until(lambda: {"control_x", "micro_x", "link_lost"} <= {gauge.name for gauge in lab.rig.gauges()})
            until(lambda: PANELS[procedure] <= lab.control.board.revisions().keys())
        lab.control.stop("Ada", "seen")
        lab.ended()
        lab.close()
