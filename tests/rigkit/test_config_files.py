"""What the files of a rig file hold is compared as its values are, by the roles of the keys that name them."""

from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.agreement import GOING_ON, MEASURED_ELSEWHERE, differences
from rigkit.config_files import sums_of
from rigkit.origin import Origin, OriginError, checksum
from stagectl.robot.config import CellConfig
from vibractl.config import RigConfig


@pytest.fixture
def rig(tmp_path: Path) -> RigConfig:
    """Return a rig with two measured responses."""
    for name in ("one.wav", "two.wav"):
        (tmp_path / name).write_bytes(name.encode())
    (tmp_path / "rig.toml").write_text(
        '[simulator]\nplant = "impulse-response"\n[simulator.options]\nfiles = ["one.wav", "two.wav"]\n'
    )
    return rig_file.load(tmp_path / "rig.toml", RigConfig)


def test_a_plants_files_are_summed_by_their_key_and_in_their_order(rig: RigConfig, tmp_path: Path) -> None:
    before = sums_of(rig)
    assert list(before) == ["simulator.options.files"]
    (tmp_path / "two.wav").write_bytes(b"three")
    assert sums_of(rig) != before
    (tmp_path / "one.wav").unlink()
    assert sums_of(rig) == {"simulator.options.files": checksum(tmp_path / "two.wav")}


def test_what_is_no_plant_and_no_wiring_is_not_summed(tmp_path: Path) -> None:
    for name in ("arm.toml", "milling.h5"):
        (tmp_path / name).write_bytes(name.encode())
    (tmp_path / "cell.toml").write_text('[robot]\narm = "arm.toml"\n')
    found = sums_of(rig_file.load(tmp_path / "cell.toml", CellConfig))
    assert found == {"robot.arm": checksum(tmp_path / "arm.toml")}


def test_another_content_is_harmful_to_what_goes_on_and_said_of_a_model(rig: RigConfig, tmp_path: Path) -> None:
    settings, sums = rig.model_dump(mode="json"), sums_of(rig)
    assert not differences(settings, rig, GOING_ON, sums)
    (tmp_path / "two.wav").write_bytes(b"three")
    (going_on,) = differences(settings, rig, GOING_ON, sums)
    (model,) = differences(settings, rig, MEASURED_ELSEWHERE, sums)
    assert (going_on.key, going_on.is_harmful, model.is_harmful) == ("simulator.options.files", True, False)
    assert going_on.text.startswith('simulator.options.files, its content, was "')
    assert not differences(settings, rig, GOING_ON.without("simulator"), sums)


def test_a_moved_lab_is_the_same_and_another_name_is_said_once(rig: RigConfig, tmp_path: Path) -> None:
    settings, sums = rig.model_dump(mode="json"), sums_of(rig)
    (tmp_path / "attic").mkdir()
    for name in ("one.wav", "two.wav", "rig.toml"):
        (tmp_path / name).rename(tmp_path / "attic" / name)
    moved = rig_file.load(tmp_path / "attic" / "rig.toml", RigConfig)
    assert not differences(settings, moved, GOING_ON, sums)
    (tmp_path / "attic" / "two.wav").rename(tmp_path / "attic" / "other.wav")
    text = (tmp_path / "attic" / "rig.toml").read_text().replace("two.wav", "other.wav")
    (tmp_path / "attic" / "rig.toml").write_text(text)
    other = rig_file.load(tmp_path / "attic" / "rig.toml", RigConfig)
    assert [each.what for each in differences(settings, other, GOING_ON, {"simulator.options.files": "0"})] == [""]


def test_a_models_words_tell_what_its_files_held() -> None:
    words = {"config": "[rig]\nname = 'A'\n", "parts": '{"robot.arm": "12"}'}
    origin = Origin.told("model", words, "m.h5")
    assert origin is not None
    assert origin.parts == {"robot.arm": "12"}
    with pytest.raises(OriginError, match="m.h5"):
        Origin.told("model", {**words, "parts": "[]"}, "m.h5")
