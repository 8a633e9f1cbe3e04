"""Files that are there whole or not at all."""

from pathlib import Path

import pytest

from rigkit import atomic


def test_a_file_is_replaced_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "model.h5"
    atomic.write(path, b"old")
    atomic.write(path, "new é")
    assert path.read_text(encoding="utf-8") == "new é"
    assert [entry.name for entry in tmp_path.iterdir()] == ["model.h5"]


def test_a_writer_that_fails_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "0000.wav"
    path.write_bytes(b"old")

    def fail_half_way() -> None:
        with atomic.replacing(path) as temporary:
            temporary.write_bytes(b"half")
            raise RuntimeError("half way")

    with pytest.raises(RuntimeError, match="half way"):
        fail_half_way()
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["0000.wav"]


def test_the_temporary_name_keeps_the_suffix_by_which_libraries_choose_a_format(tmp_path: Path) -> None:
    with atomic.replacing(tmp_path / "0000.wav") as temporary:
        assert temporary.suffix == ".wav"
        assert temporary.name.startswith(".")
        assert atomic.is_leftover(temporary)
        temporary.write_bytes(b"")


def test_only_temporary_files_are_leftovers(tmp_path: Path) -> None:
    for name in (".0000.0a1b2c3d.tmp.wav", ".model.h5.0a1b2c3d.tmp", "notes.tmp", ".hidden", ".x.tmp", "0000.wav"):
        (tmp_path / name).write_bytes(b"")
    assert sorted(path.name for path in atomic.leftovers(tmp_path)) == [
        ".0000.0a1b2c3d.tmp.wav",
        ".model.h5.0a1b2c3d.tmp",
    ]


def test_a_missing_folder_is_named_and_not_the_temporary_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as fault:
        atomic.write(tmp_path / "nowhere" / "figures.json", "")
    assert fault.value.filename == str(tmp_path / "nowhere")


def test_a_folder_that_stays_empty_goes_again_with_those_above_it_that_were_made(tmp_path: Path) -> None:
    def refuse(folder: Path, *names: str) -> None:
        with atomic.folder(folder) as made:
            for name in names:
                (made / name).write_text("")
            raise ValueError("no such shot")

    (tmp_path / "there").mkdir()
    for folder in ("there", "there/new", "a/b/c"):
        with pytest.raises(ValueError, match="no such shot"):
            refuse(tmp_path / folder)
    assert [entry.name for entry in tmp_path.iterdir()] == ["there"]
    with pytest.raises(ValueError, match="no such shot"):
        refuse(tmp_path / "a" / "b", "kept")
    assert (tmp_path / "a" / "b" / "kept").is_file()


def test_a_folder_in_a_files_place_is_named_as_a_person_has_named_it(tmp_path: Path) -> None:
    (tmp_path / "model.h5").mkdir()
    with pytest.raises(IsADirectoryError, match="is a folder, must be a file") as fault:
        atomic.write(tmp_path / "model.h5", "x")
    assert fault.value.filename == str(tmp_path / "model.h5")
    assert list(tmp_path.iterdir()) == [tmp_path / "model.h5"]
