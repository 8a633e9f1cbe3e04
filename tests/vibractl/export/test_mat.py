"""A run as a MATLAB file, read back by scipy.io."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat, whosmat

from ctlblocks import recording
from rigkit.run_folder import read_quality
from tests.vibractl.export.exported_run import recorded_run
from vibractl.export import mat
from vibractl.export.content import Content, read_content
from vibractl.export.mat import write_mat


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return read_content(recorded_run(tmp_path_factory.mktemp("run")))


@pytest.fixture(scope="module")
def file(content: Content, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mat") / "run.mat"
    write_mat(path, content)
    return path


@pytest.fixture
def run(file: Path) -> Any:
    return loadmat(file, squeeze_me=True, struct_as_record=False)["run"]


def test_the_file_is_of_version_5_and_holds_one_structure(file: Path) -> None:
    assert file.read_bytes().startswith(b"MATLAB 5.0 MAT-file")
    assert whosmat(file) == [("run", (1, 1), "struct")]


def test_the_model_comes_back_with_its_units(content: Content, run: Any) -> None:
    np.testing.assert_array_equal(run.model.response, content.matrix.response)
    np.testing.assert_array_equal(run.model.frequency, content.matrix.frequency)
    np.testing.assert_array_equal(run.model.variance, content.matrix.variance)
    assert run.model.units.response == "m/s^2/V"
    assert run.model.provenance.rig == "simulated-vibrator"


def test_shots_and_reference_come_back_bit_for_bit(content: Content, run: Any) -> None:
    assert [shot.number for shot in run.shots] == list(content.files)
    for shot in run.shots:
        wanted = content.shot(shot.number)
        np.testing.assert_array_equal(shot.data, wanted.data)
        assert shot.data.dtype == np.float32
        assert (tuple(shot.names), tuple(shot.units)) == (wanted.names, wanted.units)
    np.testing.assert_array_equal(run.reference.data, content.reference)
    assert (run.rate, run.reference.first_sample) == (44_100, 8_821)


def test_the_table_of_the_shots_has_numbers_where_it_can(content: Content, run: Any) -> None:
    rows = read_quality(content.path)
    np.testing.assert_array_equal(run.quality.iae_2, [float(row["iae_2"]) for row in rows])
    assert np.isnan(run.quality.repeatability_db[0])
    assert list(run.quality.verdict) == [row["verdict"] for row in rows]


def test_more_than_such_a_file_holds_is_refused_before_the_shots_are_read(content: Content, tmp_path: Path) -> None:
    """Of all shots but the first there is no file here."""
    files = {number: tmp_path / f"{number:04d}.wav" for number in range(2_000)} | {0: content.files[0]}
    with pytest.raises(ValueError, match="2000 shots are 2257920000 bytes, must be <= 2147483647 in a MATLAB file"):
        write_mat(tmp_path / "run.mat", replace(content, files=files))
    assert not list(tmp_path.iterdir())


def test_a_file_that_is_too_long_by_its_texts_is_refused(
    content: Content, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mat, "LARGEST", 2_257_920)  # the samples of two shots, and not one byte more
    with pytest.raises(ValueError, match=r"the run takes \d+ bytes, must be <= 2257920 in a MATLAB file; name fewer"):
        write_mat(tmp_path / "run.mat", content)


def test_a_shot_that_says_nothing_of_where_it_comes_from_is_written(content: Content, tmp_path: Path) -> None:
    shot = content.shot(0)
    recording.write(tmp_path / "0000.csv", replace(shot, provenance={}))
    write_mat(tmp_path / "run.mat", replace(content, files={0: tmp_path / "0000.csv"}))
    (back,) = loadmat(tmp_path / "run.mat", struct_as_record=False)["run"][0, 0].shots[:, 0]
    assert back.provenance.size == 0
    np.testing.assert_array_equal(back.data, shot.data)
