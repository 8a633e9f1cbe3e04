"""Relative paths in a rig file are relative to that file, and to nothing else."""

from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.config import ConfigError
from rigkit.config_edit import edited, with_tables
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from vibractl.config import RigConfig


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that is not the one that is worked in."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (tmp_path / "lab").mkdir()
    return tmp_path / "lab"


def test_what_a_file_names_lies_beside_it(lab: Path) -> None:
    (lab / "rig.toml").write_text('[daemon]\ndata = "d"\n[reference]\nsignal = "ref.wav"\n')
    config = rig_file.load("../lab/rig.toml", RigConfig)
    assert Path(config.daemon.data).resolve() == lab / "d"
    assert Path(config.reference.signal).resolve() == lab / "ref.wav"
    assert rig_file.load(lab / "rig.toml", RigConfig, as_written=True).reference.signal == "ref.wav"


def test_a_path_left_to_its_default_lies_beside_the_file_as_well(lab: Path) -> None:
    (lab / "cell.toml").write_text("")
    config = rig_file.load(lab / "cell.toml", CellConfig)
    assert config.daemon.data == str(lab / "data")
    assert config.learning.model == str(lab / "milling.h5")
    assert config.robot.arm == "irb140"
    assert rig_file.load(None, CellConfig).daemon.data == "data"


def test_what_is_no_path_stays_and_what_is_whole_as_well(lab: Path) -> None:
    (lab / "rig.toml").write_text('[daemon]\ndata = "/d"\n[reference]\nsignal = "chirp:40:90:5"\n')
    config = rig_file.load(lab / "rig.toml", RigConfig)
    assert (config.daemon.data, config.reference.signal) == ("/d", "chirp:40:90:5")


def test_what_is_set_over_a_file_is_meant_from_where_one_is(lab: Path) -> None:
    (lab / "rig.toml").write_text('[daemon]\ndata = "d"\n')
    assert rig_file.load(lab / "rig.toml", RigConfig, ["daemon.data=here"]).daemon.data == "here"


def test_each_file_of_a_list_lies_beside_it(lab: Path) -> None:
    (lab / "stage.toml").write_text('[inner]\nhysteresis = ["x.h5", "", "/z.h5"]\n')
    found = rig_file.load(lab / "stage.toml", StageConfig).inner.hysteresis
    assert found == (str(lab / "x.h5"), "", "/z.h5")


@pytest.mark.parametrize("text", ["daemon = 3\n", "[daemon]\ndata = 3\n", "[inner]\nhysteresis = [3]\n"])
def test_what_is_no_text_is_refused_as_before(lab: Path, text: str) -> None:
    (lab / "stage.toml").write_text(text)
    with pytest.raises(ConfigError):
        rig_file.load(lab / "stage.toml", StageConfig)


def test_an_edit_keeps_comments_order_and_what_is_not_edited() -> None:
    text = "# my stage\n[inner]\nsmoothing = 3e-4  # measured\ngain = [1.0]  # a guess\n\n[limits]\nramp = 0.3\n"
    found = edited(text, {"inner.gain": (2.0, 3.0), "weights.drive": [1.0]})
    assert found == (
        "# my stage\n[inner]\nsmoothing = 3e-4  # measured\ngain = [2.0, 3.0]  # a guess\n\n[limits]\nramp = 0.3\n\n"
        "[weights]\ndrive = [1.0]\n"
    )


def test_whole_tables_of_an_example_are_put_in_and_it_can_be_read(tmp_path: Path) -> None:
    config = StageConfig.model_validate({"inner": {"gain": (1e-7, 2e-7, 3e-7)}, "limits": {"ramp": 0.3}})
    (tmp_path / "s.toml").write_text(with_tables(rig_file.example(StageConfig), config, ("inner", "weights")))
    found = rig_file.load(tmp_path / "s.toml", StageConfig, as_written=True)
    assert found.inner == config.inner
    assert found.limits == StageConfig().limits
