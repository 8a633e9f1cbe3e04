"""A run takes the files in that its rig file names, and is whole wherever it is moved."""

from pathlib import Path

from rigkit import config as rig_file
from rigkit.kept_files import kept_files
from rigkit.run_folder import CONFIG, RunFolder
from stagectl.robot.config import CellConfig


def cell_file(lab: Path) -> CellConfig:
    """Write a cell's file that names an arm twice and has a model beside it; read it."""
    (lab / "arms").mkdir()
    for name in ("arm.toml", "arms/arm.toml", "milling.h5"):
        (lab / name).write_text(name)
    (lab / "cell.toml").write_text(
        '[robot]\narm = "arm.toml"\n[pocket]\narm = "arm.toml"\n[toroid]\narm = "arms/arm.toml"\n'
    )
    return rig_file.load(lab / "cell.toml", CellConfig)


def test_copies_have_their_own_names_and_are_found_beside_the_settings(tmp_path: Path) -> None:
    kept = kept_files(cell_file(tmp_path), ["learning.model"])
    with RunFolder.filled(tmp_path / "run", rig_file.dump(kept.config)) as folder:
        names = kept.take_into(folder)
    folder.close()
    assert names == ["files/1/arm.toml", "files/2/arm.toml"]
    moved = (tmp_path / "run").rename(tmp_path / "moved")
    found = rig_file.load(moved / CONFIG, CellConfig)
    assert found.robot.arm == found.pocket.arm == str(moved / "files/1/arm.toml")
    assert Path(found.toroid.arm).read_text() == "arms/arm.toml"


def test_what_is_no_file_and_what_the_run_does_not_need_stays_as_it_is(tmp_path: Path) -> None:
    cell = cell_file(tmp_path)
    (tmp_path / "arm.toml").unlink()
    kept = kept_files(cell, ["learning.model", "toroid.arm"])
    assert kept.files == {}
    assert kept.config is cell
