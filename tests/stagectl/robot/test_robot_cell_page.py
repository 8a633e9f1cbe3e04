"""docs/robot-cell.md says what the code says."""

import re

import pytest

from firmware_sim.plants.robot_arms import ARMS
from firmware_sim.robot_bench import MISHAPS
from stagectl.robot.config import CellConfig
from tests.contract.source_tree import ROOT

PAGE = (ROOT / "docs/robot-cell.md").read_text()
ROWS = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.splitlines() if line.startswith("| ")]


def test_every_mishap_is_listed_in_order() -> None:
    assert ", ".join(f"`{name}`" for name in MISHAPS) in PAGE


def test_every_key_it_names_is_in_the_file() -> None:
    cell = CellConfig()
    for table, key in re.findall(r"`(robot|limits|tracker)\.(\w+)`", PAGE):
        assert hasattr(getattr(cell, table), key), f"{table}.{key}"


@pytest.mark.parametrize(("column", "arm"), [(1, "irb140"), (2, "kuka")])
def test_the_arms_have_the_numbers_of_the_page(column: int, arm: str) -> None:
    made = ARMS[arm]
    for row, values, scale in (
        ("stiffness, kN m/rad", made.stiffness, 1e-3),
        ("stiffness across, kN m/rad", made.across, 1e-3),
        ("Coulomb friction, N m", made.coulomb, 1.0),
        ("torque limit, N m", made.torque_limit, 1.0),
    ):
        cells = next(cells for cells in ROWS if cells[0] == row)
        assert [float(each.replace(" ", "")) for each in cells[column].split(", ")] == pytest.approx(
            [scale * value for value in values]
        )
    moving = next(cells for cells in ROWS if cells[0] == "moving mass, kg")[column]
    assert int(re.match(r"\d+", moving)[0]) == round(sum(made.mass))  # type: ignore[index]
