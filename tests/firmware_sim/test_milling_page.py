"""docs/milling.md says what the code says."""

import re
from dataclasses import fields

import pytest

from firmware_sim.force_box import MISHAPS
from firmware_sim.plants.cutting_force import MATERIALS
from firmware_sim.plants.milling import PocketOptions
from stagectl.robot.config import CellConfig
from tests.contract.source_tree import ROOT

PAGE = (ROOT / "docs/milling.md").read_text()
ROWS = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.splitlines() if line.startswith("| ")]


def test_the_materials_have_the_coefficients_of_the_page() -> None:
    found = {row[0].strip("`"): row[1:3] for row in ROWS if row[0].strip("`") in MATERIALS and "," in row[1]}
    assert list(found) == list(MATERIALS)
    for name, (cutting, edge) in found.items():
        assert [1e6 * float(each) for each in cutting.split(", ")] == pytest.approx(list(MATERIALS[name].cutting))
        assert [1e3 * float(each) for each in edge.split(", ")] == pytest.approx(list(MATERIALS[name].edge))


def test_every_option_and_key_it_names_is_there() -> None:
    begin = next(n for n, row in enumerate(ROWS) if row[0] == "option")
    named = [name for row in ROWS[begin + 1 : begin + 9] for name in re.findall(r"`(\w+)`", row[0])]
    there = [each.name for each in fields(PocketOptions)]
    assert set(named) <= set(there)
    assert {"material", "spread", "origin"} | set(named) == set(there)
    for key in re.findall(r"`force_sensor\.(\w+)`", PAGE):
        assert hasattr(CellConfig().force_sensor, key), key


def test_the_boxs_mishaps_are_listed() -> None:
    assert all(f"`{name}`" in PAGE for name in MISHAPS)
