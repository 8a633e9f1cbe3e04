"""What all model files have in common: whole or not at all, units, words, and what is refused."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file

CONTENT = ModelFile(
    "a model 1",
    {"gain": np.array([[1.0, 2.0]]), "level": np.array(3.0)},
    {"gain": "um/V"},
    {"title": "stage x", "names": ("a", "b")},
    {"commit": "abc"},
)


def test_arrays_units_words_and_provenance_come_back(tmp_path: Path) -> None:
    write_model_file(tmp_path / "m.h5", CONTENT)
    back = read_model_file(tmp_path / "m.h5", "a model 1", ["gain", "level"], ["title", "names"])
    np.testing.assert_array_equal(back.arrays["gain"], CONTENT.arrays["gain"])
    assert back.arrays["level"] == 3.0
    assert (back.units, back.words, back.provenance) == (CONTENT.units, CONTENT.words, CONTENT.provenance)


def test_a_write_that_fails_leaves_the_file_before_it_and_no_other(tmp_path: Path) -> None:
    write_model_file(tmp_path / "m.h5", CONTENT)
    before = (tmp_path / "m.h5").read_bytes()
    with pytest.raises(TypeError):
        write_model_file(tmp_path / "m.h5", ModelFile("a model 1", {"gain": np.array([object()])}))
    assert (tmp_path / "m.h5").read_bytes() == before
    assert list(tmp_path.iterdir()) == [tmp_path / "m.h5"]


def test_a_kind_of_model_that_is_not_wanted_is_refused(tmp_path: Path) -> None:
    write_model_file(tmp_path / "m.h5", CONTENT)
    with pytest.raises(ModelFileError, match=r"m\.h5: format is 'a model 1', must be 'another 2'"):
        read_model_file(tmp_path / "m.h5", "another 2", [])


@pytest.mark.parametrize(("arrays", "words"), [(["gain", "lost"], []), (["gain"], ["lost"])])
def test_what_is_missing_is_refused(tmp_path: Path, arrays: list[str], words: list[str]) -> None:
    write_model_file(tmp_path / "m.h5", CONTENT)
    with pytest.raises(ModelFileError, match=r"m\.h5: not a readable model file"):
        read_model_file(tmp_path / "m.h5", "a model 1", arrays, words)


def test_a_file_cut_short_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "m.h5"
    write_model_file(path, CONTENT)
    whole = path.read_bytes()
    for length in (0, 100, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        with pytest.raises(ModelFileError, match=r"m\.h5"):
            read_model_file(path, "a model 1", ["gain"])


def test_a_file_of_another_program_is_refused(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "m.h5", "w") as file:
        file["gain"] = [1.0]
    with pytest.raises(ModelFileError, match="format is None"):
        read_model_file(tmp_path / "m.h5", "a model 1", ["gain"])


def test_a_byte_changed_anywhere_is_told_before_the_file_is_used(tmp_path: Path) -> None:
    path = tmp_path / "m.h5"
    write_model_file(path, CONTENT)
    content = path.read_bytes()
    for place in (0, 20, 512, 600, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        with pytest.raises(ModelFileError, match=r"m\.h5: not a readable model file \((was changed|is no HDF5)"):
            read_model_file(path, "a model 1", ["gain"])


def test_a_file_of_an_older_program_has_no_checksum_and_is_read(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "m.h5", "w") as file:
        file.attrs["format"] = "a model 1"
        file["gain"] = [1.0]
    assert read_model_file(tmp_path / "m.h5", "a model 1", ["gain"]).arrays["gain"] == [1.0]
