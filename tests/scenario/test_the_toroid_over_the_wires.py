"""The toroid with robot, tracker and stage behind their wires: followed, held by name, and replayed bit for bit.

Guards against a cell that works in process alone, and against a tool that leaves its path when a wire fails.
"""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from firmware_sim.stage_processor import Settings
from rigkit import config as rig_file
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, reported, run
from rigkit.experiment.runner import STOPPED, Conduct
from rigkit.run_folder import read_events
from stagectl.config import StageConfig
from stagectl.experiments.toroid.experiment import Toroid
from stagectl.experiments.toroid.plan import plan
from stagectl.experiments.toroid.read_back import TOROID, Files, plans_of
from tests.scenario.stepped_cell import StageBeside, SteppedCell
from tests.stagectl.link.stand_in import PATIENT, running

pytestmark = pytest.mark.stall(0.3)

STAGE = rig_file.load(None, StageConfig, [])
SETTINGS: dict[str, Any] = {
    "robot": {"arm": "kuka", "travel": 0.25},
    "limits": {"speed": 1.0, "highest": [2.0, 1.0, 2.5]},
    "toroid": {"lead": 1.2, "turn": 0.02, "ramp": 0.2},
    "tracker": {"blind": 0.5},
}
"""Four millimetres of the circle."""


@pytest.fixture
def cell() -> Iterator[SteppedCell]:
    with SteppedCell(**SETTINGS) as made:
        yield made


def toroid(cell: SteppedCell, setup: str, can: Path | None = None) -> Toroid:
    wired = {} if can is None else {"channel": str(can), "silence": PATIENT, "hold": PATIENT}
    config = cell.config.model_copy(update={"link": cell.config.link.model_copy(update=wired)})
    return Toroid([plan(setup, config, STAGE, is_live=True)], now=cell.now)


def milled(path: Path, made: Toroid, conduct: Conduct | None = None) -> tuple[dict[str, str], dict[str, Any]]:
    with create(path, TOROID, made.plans[0].cell, made, Files(STAGE).take_into) as folder:
        return run(folder, TOROID, made, conduct or Conduct())


def test_robot_and_tracker_keep_to_the_path_and_a_replay_makes_all_again(cell: SteppedCell, tmp_path: Path) -> None:
    reasons, found = milled(tmp_path / "run", toroid(cell, "B"))
    (row,) = found["setups"]
    assert reasons == {}
    assert row["fault"] is None
    assert 1e-6 < row["seen"]["circle_mae"] < 1e-4
    assert "circle_mae" not in row, "nobody knows what was cut"
    done = list(replayed(tmp_path / "run", TOROID))
    assert {each.recording for each in done} == {"B-cell"}
    assert [each.channel for each in done if not each.identical] == []
    reported(tmp_path / "run", TOROID)
    assert "as it was seen" in (tmp_path / "run" / "report.html").read_text()


@pytest.mark.slow
def test_the_stage_takes_up_what_the_robot_misses(tmp_path: Path) -> None:
    with (
        running(tmp_path / "can", Settings(silence=PATIENT, pace="host")) as (node, stage),
        SteppedCell(**SETTINGS) as cell,
    ):
        made = toroid(cell, "C", tmp_path / "can")
        cell.bench.plate = stage.position
        cell.beside = StageBeside(node, stage, lambda: made.ends)
        reasons, found = milled(tmp_path / "run", made)
    (row,) = found["setups"]
    assert reasons == {}
    assert row["seen"]["circle_mae"] < 3e-5
    assert max(high - low for low, high in row["travel"].values()) > 1e-6, "the stage was asked to move"
    done = list(replayed(tmp_path / "run", TOROID))
    assert {each.recording for each in done} == {"C-cell", "C-stage"}
    assert [each.channel for each in done if not each.identical] == []


def once_it_mills(made: Toroid, happen: Callable[[], object]) -> Callable[[], bool]:
    """Let something happen once the robot has followed for a while; never stop."""
    asked = 0

    def stopped() -> bool:
        nonlocal asked
        asked += made.ends is not None and made.ends.wires.reports > 0
        if asked == 400:
            happen()
        return False

    return stopped


def test_a_tracker_that_goes_blind_holds_the_robot_by_name(cell: SteppedCell, tmp_path: Path) -> None:
    made = toroid(cell, "B")
    conduct = Conduct(once_it_mills(made, lambda: cell.mishaps.append(lambda: cell.bench.suffer("blind"))))
    reasons, found = milled(tmp_path / "run", made, conduct)
    assert "the tracker is blind for 0.5" in reasons["B"]
    assert found["setups"][0]["fault"] == reasons["B"]
    told = [event["reason"] for event in read_events(tmp_path / "run") if event["event"] == "robot_fault"]
    assert told == [reasons["B"]], "told once"
    assert all(each.identical for each in replayed(tmp_path / "run", TOROID))


def test_its_user_stops_it_and_what_was_recorded_is_kept(cell: SteppedCell, tmp_path: Path) -> None:
    made, asked = toroid(cell, "A"), list[int]()
    seen = once_it_mills(made, lambda: asked.append(1))
    reasons, _ = milled(tmp_path / "run", made, Conduct(lambda: seen() or bool(asked)))
    assert reasons == {"A": STOPPED}
    assert all(each.identical for each in replayed(tmp_path / "run", TOROID))


def test_a_robot_that_is_somewhere_else_is_not_moved(tmp_path: Path) -> None:
    elsewhere = SETTINGS | {"toroid": SETTINGS["toroid"] | {"home": [0.3, -0.17453, 0.17453, 0.0, 0.5236, 0.0]}}
    with SteppedCell(**elsewhere) as cell:
        tool = cell.bench.controller.plant.frames[7, :, 3]
        before = tool.copy()
        with pytest.raises(ValueError, match=r"the robot has the workpiece at .* bring it near the joints 0\.3"):
            milled(tmp_path / "run", toroid(cell, "B"))
        np.testing.assert_allclose(tool, before, atol=1e-5)


def test_what_does_not_fit_the_wire_is_refused_before_anything_moves(cell: SteppedCell) -> None:
    stage = rig_file.load(None, StageConfig, ["limits.travel=[1e-5, 4e-5]"])
    with pytest.raises(ValueError, match=r"link.origin is 0.000225 m, must be 2.5e-05 m"):
        Toroid([plan("C", cell.config, stage, is_live=True)])
    with pytest.raises(ValueError, match=r"--model goes with a simulated stage"):
        plans_of("C", cell.config, Files(STAGE, [Path("a.h5")]), is_live=True)


def test_its_run_says_that_it_was_live(cell: SteppedCell, tmp_path: Path) -> None:
    made = toroid(cell, "A")
    with create(tmp_path / "run", TOROID, made.plans[0].cell, made, Files(STAGE).take_into):
        pass
    assert json.loads((tmp_path / "run" / "run.json").read_text())["designed"] == {
        "setups": ["A"], "live": True, "loops": {},
    }  # fmt: skip
