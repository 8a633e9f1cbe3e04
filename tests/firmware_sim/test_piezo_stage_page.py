"""docs/piezo-stage.md names every option, with its default and its range, and its figures can be drawn."""

import re
import subprocess
import sys
from dataclasses import fields
from math import inf
from pathlib import Path

import pytest

from firmware_sim.plants.milling_disturbance import MillingOptions
from firmware_sim.plants.piezo_stage_options import PiezoStageOptions

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/piezo-stage.md").read_text()
ROWS = {
    row.split("|")[1].strip(): [cell.strip() for cell in row.split("|")[2:]]
    for row in PAGE.splitlines()
    if row[:2] == "| "
}


@pytest.mark.parametrize("options", [PiezoStageOptions, MillingOptions])
def test_every_option_has_its_row_with_default_and_range(options: type) -> None:
    for each in fields(options):
        default, allowed, *_ = ROWS[f"`{each.name}`"]
        if "range" not in each.metadata:
            assert each.default == default.strip('"')
            assert all(f'"{word}"' in allowed for word in each.metadata["allowed"])
            continue
        low, high = each.metadata["range"]
        said = [float(number) for number in re.findall(r"-?[\d.]+(?:e-?\d+)?", allowed)]
        assert float(default) == each.default, each.name
        assert said == ([low] if high == inf else [low, high]), each.name


@pytest.mark.slow
def test_the_figures_are_drawn(tmp_path: Path) -> None:
    script = [sys.executable, ROOT / "examples/piezo_stage.py", tmp_path]
    done = subprocess.run(script, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    drawn = {file.name for file in tmp_path.iterdir()}
    assert drawn == set(re.findall(r"images/piezo-stage/(\w+\.png)", PAGE))
