"""The far field is kept with its delay, interpolates without it, and old models are read without it."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from rigkit.model_file import ModelFileError
from rigkit.sealed_file import seal
from vibractl.far_field import FarField, delayed
from vibractl.model_file import read_far_field, read_model, write_model
from vibractl.transfer_matrix import TransferMatrix

LINES = np.arange(20.0, 100.0, 2.0)
DELAY = np.array([0.1, 0.0071])


def matrix(outputs: int = 2) -> TransferMatrix:
    shape = (len(LINES), outputs, 2)
    return TransferMatrix(LINES, np.ones(shape) + 0j, np.full(shape, 1e-4), np.ones(shape), {"rig": "a"})


def far_field() -> FarField:
    return FarField(matrix(), DELAY)


def test_a_far_field_comes_back_from_its_file(tmp_path: Path) -> None:
    write_model(tmp_path / "m.h5", matrix(), far_field())
    back = read_far_field(tmp_path / "m.h5", 2)
    assert back is not None
    np.testing.assert_allclose(back.prompt.response, far_field().prompt.response, atol=1e-12)
    np.testing.assert_array_equal(back.prompt.variance, far_field().prompt.variance)
    np.testing.assert_array_equal(back.delay, DELAY)
    assert read_model(tmp_path / "m.h5", (2, 2)).outputs == 2
    with h5py.File(tmp_path / "m.h5") as file:
        stored = np.asarray(file["far_field_response"])
        assert file["far_field_response"].attrs["unit"] == "Pa/(m/s^2)"
    np.testing.assert_allclose(np.angle(stored[0, 1, 0]), -2 * np.pi * 20.0 * 0.0071, atol=1e-9)


def test_a_model_without_hydrophones_has_no_far_field(tmp_path: Path) -> None:
    write_model(tmp_path / "m.h5", matrix())
    assert read_far_field(tmp_path / "m.h5", 2) is None
    write_model(tmp_path / "m.h5", matrix(), far_field())
    assert read_far_field(tmp_path / "m.h5", 0) is None


def test_a_far_field_that_does_not_fit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "m.h5"
    write_model(path, matrix(), far_field())
    with pytest.raises(ModelFileError, match="measured with 2 hydrophones, this rig has 3"):
        read_far_field(path, 3)
    for name, value, said in (
        ("far_field_delay", np.array([0.1, np.nan]), "delays of 2 hydrophones"),
        ("far_field_variance", np.ones((3, 2, 2)), r"variance has shape \(3, 2, 2\)"),
        ("far_field_response", np.ones((len(LINES), 2, 3)), "must end in the accelerometers"),
        (
            "far_field_coherence",
            None,
            "of the far field there is far_field_response, far_field_variance, far_field_del",
        ),
    ):
        write_model(path, matrix(), far_field())
        with h5py.File(path, "r+") as file:
            del file[name]
            if value is not None:
                file[name] = value
        seal(path)
        with pytest.raises(ModelFileError, match=said):
            read_far_field(path)


def test_a_long_delay_does_not_spoil_interpolation() -> None:
    between = np.arange(21.0, 95.0, 2.0)
    found = far_field().at(between)
    expected = np.exp(-2j * np.pi * np.outer(between, DELAY))[..., None] * np.ones(2)
    np.testing.assert_allclose(found.response, expected, atol=1e-12)


def test_who_listens_later_hears_sooner() -> None:
    found = far_field().later(np.array([0.1, 0.0]))
    np.testing.assert_allclose(found[:, 0], 1.0)
    np.testing.assert_allclose(found[:, 1], far_field().response[:, 1])


def test_the_delay_is_in_the_phase_once() -> None:
    rebuilt = delayed(LINES, far_field().response, *(np.ones((len(LINES), 2, 2)),) * 2, DELAY)
    np.testing.assert_allclose(rebuilt.prompt.response, 1.0, atol=1e-12)
