"""docs/force-control.md says what the code says."""

import re

import pytest

from firmware_sim.force_sensor_block import ForceSensor
from firmware_sim.guided_robot import GuidedRobot
from firmware_sim.plants.oak import OakOptions
from stagectl.experiments.feed.job import POCKETS, PROCESS
from stagectl.experiments.feed.plan import RATE
from stagectl.experiments.feed.recorded import SLOW
from stagectl.robot.config import CellConfig
from tests.contract.source_tree import ROOT

PAGE = (ROOT / "docs/force-control.md").read_text()


def test_every_key_it_names_is_in_the_file() -> None:
    cell, found = CellConfig(), re.findall(r"`(force|segments|feed_plants)\.(?!csv)(\w+)", PAGE)
    assert len(found) > 8
    for table, key in found:
        assert hasattr(getattr(cell, table), key), f"{table}.{key}"


def test_the_faults_it_names_are_options_of_the_plants() -> None:
    line = next(each for each in PAGE.splitlines() if each.startswith("Faults of the simulated cell"))
    sensor, _, robot = line.partition(";")
    for plant, text in ((ForceSensor, sensor), (GuidedRobot, robot)):
        for name in re.findall(r"`(?:plants\.\w+_options\.)?(\w+)`", text):
            assert name in plant.__dataclass_fields__, name


def test_every_task_has_its_row() -> None:
    for task in (*POCKETS, PROCESS):
        assert f"\n| `{task}` |" in PAGE


def test_the_files_it_names_are_there() -> None:
    for name in re.findall(r"`((?:stagectl|firmware_sim)/[\w/]+\.py)`", PAGE):
        assert (ROOT / name).exists(), name
    for name in re.findall(r"\]\((images/[^)]+)\)", PAGE):
        assert (ROOT / "docs" / name).exists(), name


def test_the_rates_are_those_of_the_graph() -> None:
    assert f"| {RATE / 1e3:g} kHz | simulated" in PAGE
    assert f"| {RATE / SLOW:g} Hz (`every={SLOW}`) |" in PAGE


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stiffness", "150 N/mm of wood and tool"),
        ("spread", "varies by 12 % from place"),
        ("knot", "1.8 times as hard"),
        ("wear", "wears by 2 % a metre"),
    ],
)
def test_the_oak_has_the_numbers_of_the_page(name: str, words: str) -> None:
    value = getattr(OakOptions(), name)
    assert words in PAGE
    number = float(re.search(r"\d+\.?\d*", words)[0])  # type: ignore[index]
    assert number == pytest.approx(value * {"stiffness": 1e-3, "spread": 100, "knot": 1, "wear": 100}[name])
