"""docs/cell.md says what the code says."""

import re

from firmware_sim.guided_robot import GuidedRobot
from firmware_sim.tracker_block import TrackerView
from stagectl.devices.signals import QUICK, SLOW
from stagectl.experiments.toroid.plan import RATE, SETUPS
from stagectl.robot.config import CellConfig
from tests.contract.source_tree import ROOT

PAGE = (ROOT / "docs/cell.md").read_text()
ROWS = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.splitlines() if line.startswith("| ")]


def test_every_key_it_names_is_in_the_file() -> None:
    cell = CellConfig()
    found = re.findall(r"`(toroid|feedback|plants|robot|tracker|limits)\.(\w+)", PAGE)
    assert len(found) > 10
    for table, key in found:
        assert hasattr(getattr(cell, table), key), f"{table}.{key}"


def test_every_option_it_names_is_one_of_a_plant() -> None:
    listed = PAGE[PAGE.index("Faults of the simulated cell come by option") :].partition("\n\n")[0]
    robot, _, tracker = listed.partition("tracker_options")
    for plant, text in ((GuidedRobot, robot), (TrackerView, tracker)):
        for name in re.findall(r"`(?:plants\.\w+_options)?\.?(\w+)`", text):
            assert name in plant.__dataclass_fields__, name


def test_every_setup_has_its_row() -> None:
    assert {f"`{setup}`" for setup in SETUPS} <= {row[0] for row in ROWS}


def test_the_files_it_names_are_there() -> None:
    for name in re.findall(r"`((?:stagectl|firmware_sim)/[\w/]+\.py)`", PAGE):
        assert (ROOT / name).exists(), name
    for name in re.findall(r"`(firmware_sim(?:\.\w+)+)`", PAGE):
        assert (ROOT / f"{name.replace('.', '/')}.py").exists(), name


def test_the_rates_are_those_of_the_graph() -> None:
    assert f"2 kHz (`every={QUICK}`)" in PAGE
    assert RATE / QUICK == 2_000.0
    assert f"250 Hz (`every={SLOW}`)" in PAGE
    assert RATE / SLOW == 250.0
