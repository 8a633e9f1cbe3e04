"""The innovation model's file."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from rigkit.model_file import ModelFileError
from rigkit.sealed_file import seal
from stagectl.models.model_file import read_measured, read_model, write_model
from stagectl.stage.measured_response import MeasuredResponse
from tests.calibration.state_space.test_model import resonant

NAMED = replace(
    resonant(),
    input_names=("drive", "Störung"),
    output_names=("x", "y", "z"),
    input_units=("V", "N"),
    output_units=("um",) * 3,
    provenance={"rig": "stage", "recording": "a.wav"},
)


def test_a_model_comes_back_bit_for_bit(tmp_path: Path) -> None:
    write_model(tmp_path / "m.h5", NAMED)
    back = read_model(tmp_path / "m.h5", NAMED.rate, NAMED.input_names, NAMED.output_names)
    for name in ("A", "B", "C", "D", "K", "innovation"):
        np.testing.assert_array_equal(getattr(back, name), getattr(NAMED, name))
    words = ("rate", "input_names", "output_names", "input_units", "output_units", "provenance")
    assert [getattr(back, name) for name in words] == [getattr(NAMED, name) for name in words]
    assert list(tmp_path.iterdir()) == [tmp_path / "m.h5"]


def test_a_model_of_another_rate_or_other_signals_is_refused(tmp_path: Path) -> None:
    write_model(tmp_path / "m.h5", NAMED)
    with pytest.raises(ModelFileError, match="sampled at 1000 samples/s, must be 10000"):
        read_model(tmp_path / "m.h5", 10_000.0)
    with pytest.raises(ModelFileError, match="outputs are x, y, z, must be z, y, x"):
        read_model(tmp_path / "m.h5", outputs=("z", "y", "x"))


def test_what_was_heard_of_the_plant_comes_back_and_need_not_be_there(tmp_path: Path) -> None:
    heard = MeasuredResponse(np.array([1.0, 2.0]), np.array([1 + 2j, 0j]), np.array([0j, 3 - 1j]))
    write_model(tmp_path / "m.h5", NAMED, heard)
    back = read_measured(tmp_path / "m.h5")
    assert back is not None
    for name in ("frequency", "position", "seen"):
        np.testing.assert_array_equal(getattr(back, name), getattr(heard, name))
    assert read_model(tmp_path / "m.h5").rate == NAMED.rate
    write_model(tmp_path / "m.h5", NAMED)
    assert read_measured(tmp_path / "m.h5") is None


@pytest.mark.parametrize(("name", "said"), [("measured.seen", "measured.seen"), ("measured.frequency", "must be > 0")])
def test_a_part_of_what_was_heard_is_refused(tmp_path: Path, name: str, said: str) -> None:
    heard = MeasuredResponse(np.array([1.0, 2.0]), np.ones(2, complex), np.ones(2, complex))
    write_model(tmp_path / "m.h5", NAMED, heard)
    with h5py.File(tmp_path / "m.h5", "a") as file:
        if name == "measured.seen":
            del file[name]
        else:
            file[name][:] = [2.0, 1.0]
    seal(tmp_path / "m.h5")
    with pytest.raises(ModelFileError, match=said):
        read_measured(tmp_path / "m.h5")


def damaged(path: Path, fault: str) -> None:
    """Write a model file, then spoil it."""
    write_model(path, NAMED)
    with h5py.File(path, "a") as file:
        match fault:
            case "no K":
                del file["K"]
            case "no names":
                del file.attrs["input_names"]
            case "other format":
                file.attrs["format"] = "vibrostage transfer matrix 1"
            case "infinite":
                file["A"][0, 0] = np.inf
            case "two rates":
                del file["rate"]
                file["rate"] = [1.0, 2.0]
            case "rate in words":
                del file["rate"]
                file["rate"] = "fast"
            case "A is a group":
                del file["A"]
                file.create_group("A")
    seal(path)


@pytest.mark.parametrize(
    "fault", ["no K", "no names", "other format", "infinite", "two rates", "rate in words", "A is a group"]
)
def test_a_damaged_file_is_refused_by_its_name(tmp_path: Path, fault: str) -> None:
    damaged(tmp_path / "m.h5", fault)
    with pytest.raises(ModelFileError, match=r"m\.h5: "):
        read_model(tmp_path / "m.h5")


def test_what_is_no_file_or_no_hdf5_is_refused_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "text.h5").write_text("hello")
    for path in (tmp_path / "none.h5", tmp_path / "text.h5", tmp_path):
        with pytest.raises(ModelFileError, match=path.name):
            read_model(path)
