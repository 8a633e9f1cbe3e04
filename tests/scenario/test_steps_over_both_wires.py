"""Steps on the robot behind guided motion and on the stage behind its CAN adapter: both answer, and are read off.

Guards against an experiment that works in process alone.
"""

from pathlib import Path

import numpy as np
import pytest

from firmware_sim.stage_processor import Settings
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, run
from rigkit.experiment.runner import Conduct
from stagectl.experiments.step.experiment import STEPS, Steps
from stagectl.experiments.step.response import Wanted
from tests.scenario.stepped_cell import StageBeside, SteppedCell
from tests.scenario.test_mid_ranging_over_both_wires import MIDRANGING, cell_of
from tests.stagectl.link.stand_in import PATIENT, running

pytestmark = pytest.mark.stall(0.3)


@pytest.mark.slow
@pytest.mark.parametrize("wire", ["egm", "rsi"])
def test_robot_and_stage_are_told_apart_by_what_they_answer(wire: str, tmp_path: Path) -> None:
    wanted = Wanted(size=140e-6, period=2.0, repeats=2)
    with (
        running(tmp_path / "can", Settings(silence=PATIENT, pace="host")) as (node, stage),
        SteppedCell(midranging=MIDRANGING, robot={"wire": wire}) as stepped,
    ):
        made = Steps(cell_of(stepped, tmp_path / "can"), wanted)
        stepped.beside = StageBeside(node, stage, lambda: made.pair)
        with create(tmp_path / "run", STEPS, made.cell, made) as folder:
            reasons, found = run(folder, STEPS, made, Conduct())
    assert reasons == {}
    assert all(each.identical for each in replayed(tmp_path / "run", STEPS))
    assert found["robot"]["gain"] == pytest.approx(1.0, abs=0.15)  # its joints stick
    assert found["robot"]["time_constant"] < 0.5
    assert found["stage"]["gain"] == pytest.approx(1.0, abs=0.01)
    assert found["stage"]["time_constant"] == pytest.approx(made.config.session.smoothing, abs=3e-3)
    assert found["stage"]["unexplained"] < 0.05 < found["robot"]["unexplained"]
    assert np.abs(stage.position[0]) < 1e-9  # at mid-travel in the end
