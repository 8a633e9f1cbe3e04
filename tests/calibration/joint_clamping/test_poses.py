"""Clamping poses from the command line and a file, advice on them, and what several poses need."""

from pathlib import Path

import numpy as np
import pytest

from calibration.guided_arm import arm_with_tool
from calibration.joint_clamping import advice_table
from calibration.joint_clamping.full_stiffness import Clamping
from calibration.joint_clamping.poses import in_poses
from calibration.joint_clamping.several_poses import whole_arm
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward

CELL = CellConfig()


def test_poses_come_from_the_command_line_then_from_a_file_or_else_from_the_cell(tmp_path: Path) -> None:
    file = tmp_path / "poses.csv"
    file.write_text("# deg\n1,2,3,4,5,6\n\n 6, 5,4,3,2,1\n")
    poses = [each.clamping.pose for each in in_poses(CELL, ["0,0,0,0,30,0"], file)]
    assert poses == [(0, 0, 0, 0, 30, 0), (1, 2, 3, 4, 5, 6), (6, 5, 4, 3, 2, 1)]
    assert [each.clamping.pose for each in in_poses(CELL, [], None)] == [CELL.clamping.pose]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["1,2,3"], "--pose: a pose is '1,2,3', must be 6 finite numbers"),
        (["1,2,3,4,5,x"], "must be 6 finite numbers"),
        (["1,2,3,4,5,nan"], "must be 6 finite numbers"),
        (["1,2,3,4,5,6", "1,2,3,4,5,6.0"], "is given twice"),
    ],
)
def test_poses_that_are_none_are_refused(given: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        in_poses(CELL, given, None)


def test_a_file_without_poses_is_refused(tmp_path: Path) -> None:
    (tmp_path / "poses.csv").write_text("# none\n")
    with pytest.raises(ValueError, match="has no line with a pose"):
        in_poses(CELL, [], tmp_path / "poses.csv")


def test_advice_stays_within_the_cells_limits_and_ranks_each_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(advice_table, "CANDIDATES", 60)
    arm = arm_with_tool(CELL)
    found = advice_table.advice(CELL, arm, (0, 2))
    assert [each.joint for each in found] == [0, 0, 0, 2, 2, 2]
    assert found[0].measured_share >= found[1].measured_share >= found[2].measured_share
    tool = forward(arm, np.array([each.pose for each in found]))[:, :3, 3]
    assert (tool >= CELL.limits.lowest).all()
    assert (tool <= CELL.limits.highest).all()
    assert len(advice_table.rows(found)[0]) == len(advice_table.HEAD)
    assert advice_table.figures(found)[3]["joint"] == 3
    small = CELL.limits.model_copy(update={"lowest": (0.0, 0.0, 0.0), "highest": (0.01, 0.01, 0.01)})
    with pytest.raises(ValueError, match=r"no clamping pose lies within limits.lowest"):
        advice_table.advice(CELL.model_copy(update={"limits": small}), arm, (0,))


def test_too_few_experiments_say_what_is_wanted() -> None:
    arm = arm_with_tool(CELL)
    one = Clamping(np.radians(CELL.clamping.pose), 0, np.full(6, 1e-5))
    assert "1 experiments, must be more than 13 and with every joint" in str(whole_arm(arm, [one]))
