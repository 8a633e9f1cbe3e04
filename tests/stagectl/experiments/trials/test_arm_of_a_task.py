"""The arm that mills a pocket is the cell's, unless another one is simulated on purpose."""

import pytest

from rigkit import config as rig_file
from stagectl.experiments.trials.trial import cell_for_task, first_trial
from stagectl.robot.config import CellConfig


@pytest.mark.parametrize("task", ["pocket28", "pocket28-deep", "pocket"])
def test_the_arm_of_the_cell_mills_every_pocket(task: str) -> None:
    cell = cell_for_task(rig_file.load(None, CellConfig, ["robot.arm=kuka"]), task, is_live=True)
    assert (cell.robot.arm, cell.pocket.arm) == ("kuka", "kuka")
    assert first_trial(cell, task).plant_options()["robot"]["arm"] == "kuka"


def test_another_arm_is_simulated_where_the_pocket_names_one_and_is_refused_live() -> None:
    given = rig_file.load(None, CellConfig, ["pocket.arm=kuka"])
    assert cell_for_task(given, "pocket").robot.arm == "kuka"
    with pytest.raises(ValueError, match="pocket.arm is 'kuka' and robot.arm 'irb140', must be the same in a live run"):
        cell_for_task(given, "pocket", is_live=True)
