"""Mid-ranging with the robot behind guided motion and the stage behind its CAN adapter: both follow, faults end safely.

Guards against a live run that works in process alone, and against one end that moves on when the other has gone.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from firmware_sim.stage_processor import Settings
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, records_of, reported, run
from rigkit.experiment.runner import Conduct
from rigkit.run_folder import read_events
from stagectl.experiments.midranging.experiment import Midranging
from stagectl.experiments.midranging.measures import channel
from stagectl.experiments.midranging.read_back import MIDRANGING as KIND
from stagectl.experiments.midranging.scenario import Scenario
from stagectl.link.bus import LinkError
from stagectl.robot.config import CellConfig
from stagectl.wire.messages import State
from tests.scenario.stepped_cell import BUSY, StageBeside, SteppedCell
from tests.stagectl.link.stand_in import PATIENT, link_to, running
from tests.until import until

pytestmark = pytest.mark.stall(0.3)

MIDRANGING: dict[str, Any] = {
    "session": {"live": True, "lead": 0.1},
    "pair": {"slow_outputs": [0.98], "slow_inputs": [0.02], "travel": 150e-6},
}

_UNSATISFIED = {
    "seconds": 1.0,
    "accuracy": 1e-12,
    "acceptable": 1e-12,
    "fast_amplitude": 20e-6,
    "slow_amplitude": 50e-6,
    "half_periods": 1.0,
}


def cell_of(stepped: SteppedCell, wire: Path) -> CellConfig:
    link = link_to(wire, silence=PATIENT, patience=BUSY)
    return stepped.config.model_copy(update={"link": link})


@pytest.mark.parametrize("wire", ["egm", "rsi"])
def test_the_robot_takes_over_from_the_stage_along_two_axes(wire: str, tmp_path: Path) -> None:
    wave = 50e-6 * np.sin(np.linspace(0.0, 2.0 * np.pi, 250))
    chosen = {"y": Scenario("wave", wave), "z": Scenario("wave", np.full(250, 40e-6))}
    with (
        running(tmp_path / "can", Settings(silence=PATIENT, pace="host")) as (node, stage),
        SteppedCell(midranging=MIDRANGING, robot={"wire": wire}) as stepped,
    ):
        made = Midranging(cell_of(stepped, tmp_path / "can"), "mvpc", chosen)
        stepped.beside = StageBeside(node, stage, lambda: made.pair)
        with create(tmp_path / "run", KIND, made.cell, made) as folder:
            run(folder, KIND, made, Conduct())
    runs = made.runs(records_of(tmp_path / "run"))
    assert all(each.identical for each in replayed(tmp_path / "run", KIND))
    assert list(runs) == ["y", "z"]
    assert len(runs["y"].data) == 250
    y, z = (channel(each, "slow") for each in runs.values())
    assert np.abs(z[-1] - 40e-6) < 20e-6  # by and by the robot does it alone
    assert np.abs(channel(runs["z"], "relative")[100:] - 40e-6).max() < 20e-6
    assert np.corrcoef(y[20:], wave[:-20])[0, 1] > 0.5
    assert np.abs(channel(runs["y"], "fast")).max() > 5e-6
    assert np.abs(stage.position[0]) < 1e-9


def test_where_valve_position_control_takes_over_the_event_is_kept_once_both_are_at_rest(tmp_path: Path) -> None:
    """No model is as accurate as these settings require."""
    told = {"session": {"live": True, "lead": 1.2}, "estimating": _UNSATISFIED}
    with (
        running(tmp_path / "can", Settings(silence=PATIENT, pace="host")) as (node, stage),
        SteppedCell(midranging={**MIDRANGING, **told}) as stepped,
    ):
        made = Midranging(cell_of(stepped, tmp_path / "can"), "aimc", {"y": Scenario("hold", np.full(50, 20e-6))})
        stepped.beside = StageBeside(node, stage, lambda: made.pair)
        with create(tmp_path / "run", KIND, made.cell, made) as folder:
            run(folder, KIND, made, Conduct())
    (event,) = [each for each in read_events(tmp_path / "run") if each["event"] == "taken over"]
    assert "accurate enough" in event["reason"]
    assert reported(tmp_path / "run", KIND)["taken_over_at"] == 0.0


@pytest.mark.slow
def test_a_fault_of_the_robot_sends_the_stage_to_mid_travel_and_keeps_what_was_recorded(tmp_path: Path) -> None:
    """A reference that jumps by 50 mm asks the robot for more than its speed."""
    wave = np.concatenate([np.full(100, 30e-6), np.full(100, 50e-3)])
    with (
        running(tmp_path / "can", Settings(silence=PATIENT, pace="host")) as (node, _),
        SteppedCell(midranging=MIDRANGING) as stepped,
    ):
        made = Midranging(cell_of(stepped, tmp_path / "can"), "mvpc", {"": Scenario("jump", wave)})
        with (
            create(tmp_path / "run", KIND, made.cell, made) as folder,
            pytest.raises(LinkError, match="the tool is asked to move at .* m/s, must be <= 0.25 m/s"),
        ):
            run(folder, KIND, made, Conduct())
        until(lambda: node.processor.state is not State.FOLLOWING)  # it has yet to read that it is to stop
        # FAULT where the reference, which no frame carries either, was to go out before the host heard of the robot's
        assert node.processor.state in (State.RAMPING, State.HOLDING, State.FAULT)
    assert 100 <= len(records_of(tmp_path / "run")["recording"].data) < 225
    assert "must be <= 0.25 m/s" in read_events(tmp_path / "run")[-1]["reason"]
    assert reported(tmp_path / "run", KIND)["seconds"] < 0.8


def test_what_cannot_run_live_is_refused_before_a_wire_is_opened() -> None:
    config = CellConfig.model_validate({"midranging": {"session": {"live": True}}})
    with pytest.raises(ValueError, match="a live run has the axes w .* must be of x, y, z"):
        Midranging(config, "aimc", {"w": Scenario("hold", np.zeros(10))})
