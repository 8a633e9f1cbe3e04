"""Options of code that are files, by its signature, are relative to the rig file; others are not looked at."""

import sys
from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.config import ConfigError, Section
from rigkit.config_options import file_options, option_tables
from rigkit.config_paths import keys
from rigkit.service.read_again import ReadAgain
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from vibractl.config import RigConfig

PLAYER = """
from __future__ import annotations
from dataclasses import dataclass
from pathlib import Path

@dataclass
class Player:
    file: Path | None
    others: list[str | Path]
    word: str
"""


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that is not the one that is worked in, with code of its own to be named."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (tmp_path / "code").mkdir()
    (tmp_path / "code" / "lab_player.py").write_text(PLAYER)
    monkeypatch.syspath_prepend(tmp_path / "code")
    monkeypatch.delitem(sys.modules, "lab_player", raising=False)
    (tmp_path / "lab").mkdir()
    return tmp_path / "lab"


def stage(lab: Path, name: str = "lab_player:Player") -> Path:
    """Write a stage's file whose surroundings are named."""
    (lab / "stage.toml").write_text(
        f'[simulator]\nsurroundings = "{name}"\n[simulator.surroundings_options]\n'
        'file = "a.csv"\nothers = ["b.csv", "/c.csv"]\nword = "fast"\n'
    )
    return lab / "stage.toml"


def test_the_files_of_a_plant_lie_beside_the_rig_file(lab: Path) -> None:
    (lab / "rig.toml").write_text(
        '[simulator]\nplant = "impulse-response"\n[simulator.options]\nfiles = ["one.wav", "/two.wav"]\n'
    )
    found = rig_file.load(lab / "rig.toml", RigConfig)
    assert found.simulator.options == {"files": [str(lab / "one.wav"), "/two.wav"]}
    as_written = rig_file.load(lab / "rig.toml", RigConfig, as_written=True)
    assert as_written.simulator.options == {"files": ["one.wav", "/two.wav"]}


def test_the_signature_says_which_options_are_files(lab: Path) -> None:
    found = rig_file.load(stage(lab), StageConfig)
    assert found.simulator.surroundings_options == {
        "file": str(lab / "a.csv"), "others": [str(lab / "b.csv"), "/c.csv"], "word": "fast"
    }  # fmt: skip
    assert {key[-1] for key in file_options(found)} == {"file", "others"}


def test_an_option_that_is_set_over_a_file_is_meant_from_where_one_is(lab: Path) -> None:
    found = rig_file.load(stage(lab), StageConfig, ['simulator.surroundings_options.file="here.csv"'])
    assert found.simulator.surroundings_options["file"] == "here.csv"
    assert found.simulator.surroundings_options["others"] == [str(lab / "b.csv"), "/c.csv"]


@pytest.mark.parametrize("name", ["no_such_module:Player", "lab_player:Nobody", "lab_broken:Player"])
def test_code_that_cannot_be_had_is_left_to_whoever_uses_it(lab: Path, name: str) -> None:
    (lab.parent / "code" / "lab_broken.py").write_text("raise RuntimeError('broken')\n")
    assert rig_file.load(stage(lab, name), StageConfig).simulator.surroundings_options["file"] == "a.csv"


def test_a_file_without_text_among_its_options_imports_nothing(lab: Path) -> None:
    (lab / "stage.toml").write_text(
        '[simulator]\nsurroundings = "lab_player:Player"\n[simulator.surroundings_options]\nword = 3\n'
    )
    rig_file.load(lab / "stage.toml", StageConfig)
    assert "lab_player" not in sys.modules


def test_a_daemon_imports_nothing_that_an_edit_names(lab: Path) -> None:
    read = ReadAgain(stage(lab, "stagectl.still:Still"), StageConfig, ())
    assert read().simulator.surroundings_options["file"] == "a.csv"
    stage(lab)
    assert read().simulator.surroundings_options["file"] == "a.csv"
    assert "lab_player" not in sys.modules


def test_a_daemon_finds_the_files_of_what_it_was_started_with(lab: Path) -> None:
    read = ReadAgain(stage(lab), StageConfig, ())
    assert read() == read()
    assert read().simulator.surroundings_options["file"] == str(lab / "a.csv")


def test_wrong_values_are_refused_as_before(lab: Path) -> None:
    (lab / "stage.toml").write_text("[simulator]\nsurroundings_options = 3\n")
    with pytest.raises(ConfigError, match="surroundings_options is 3"):
        rig_file.load(lab / "stage.toml", StageConfig)


@pytest.mark.parametrize("model", [RigConfig, StageConfig, CellConfig])
def test_every_table_of_keywords_says_whose_they_are(model: type[Section]) -> None:
    """But for those of a bus: python-can's classes take no files."""
    known = {table.key for table in option_tables(model)}
    tables = {key for key, field in keys(model) if str(field.annotation).startswith("dict[str")}
    assert {key for key in tables - known if key[-2] not in ("link", "relay")} == set()
    assert known


def test_the_arms_of_tasks_lie_beside_the_cells_file(lab: Path) -> None:
    (lab / "cell.toml").write_text('[robot]\narm = "a.toml"\n[pocket]\narm = "a.toml"\n[toroid]\narm = "a.toml"\n')
    found = rig_file.load(lab / "cell.toml", CellConfig)
    assert {found.robot.arm, found.pocket.arm, found.toroid.arm} == {str(lab / "a.toml")}
