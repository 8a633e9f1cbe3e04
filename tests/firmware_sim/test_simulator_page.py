"""docs/simulator.md names every plant and every option, with its default and its range."""

import inspect
import re
from dataclasses import MISSING, fields, is_dataclass
from math import inf
from pathlib import Path

import pytest

from firmware_sim.laboratory import PLANTS
from firmware_sim.plant_blocks import ImpulseResponse, Vibrator, VibratorArray, VibratorImpulseResponse

PAGE = (Path(__file__).parents[2] / "docs/simulator.md").read_text()
ROWS = {
    row.split("|")[1].strip(): [cell.strip() for cell in row.split("|")[2:]]
    for row in PAGE.splitlines()
    if row[:2] == "| "
}
BLOCKS = (Vibrator, VibratorArray, ImpulseResponse, VibratorImpulseResponse)


def test_every_plant_has_its_row() -> None:
    assert {f"`{name}`" for name in PLANTS} <= set(ROWS)


@pytest.mark.parametrize("block", BLOCKS)
def test_every_option_has_its_row(block: type) -> None:
    assert [name for name in inspect.signature(block).parameters if f"`{name}`" not in ROWS] == []


@pytest.mark.parametrize("block", [block for block in BLOCKS if is_dataclass(block)])
def test_defaults_and_ranges_on_the_page_are_those_of_the_code(block: type) -> None:
    for each in fields(block):
        if "range" not in each.metadata:
            continue
        default, _, allowed, *_ = ROWS[f"`{each.name}`"]
        low, high = each.metadata["range"]
        said = [float(number) for number in re.findall(r"-?[\d.]+(?:e\d+)?", allowed)]
        assert each.default is not MISSING
        assert float(default) == each.default, each.name
        assert said == ([low] if high == inf else [low, high]), each.name
