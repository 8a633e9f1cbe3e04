"""That records are taken as people have them, and that what is none is refused by name."""

import warnings
from typing import Any

import numpy as np
import pytest

from calibration.records import as_records, side_of

SIGNAL = np.arange(24.0).reshape(12, 2)


class Table:
    """As pandas and polars hand themselves over."""

    def __init__(self, values: np.ndarray, columns: list[str]) -> None:
        self._values, self.columns = values, columns

    def to_numpy(self) -> np.ndarray:
        return self._values


class Column:
    def __init__(self, values: np.ndarray, name: str | None) -> None:
        self._values, self.name = values, name

    def to_numpy(self) -> np.ndarray:
        return self._values


@pytest.mark.parametrize(
    ("signal", "wanted"),
    [
        (SIGNAL, [SIGNAL]),
        (SIGNAL.tolist(), [SIGNAL]),
        (SIGNAL[:, 0], [SIGNAL[:, :1]]),
        (SIGNAL[:, 0].tolist(), [SIGNAL[:, :1]]),
        (SIGNAL.astype(np.int16), [SIGNAL]),
        ([SIGNAL, SIGNAL[:5]], [SIGNAL, SIGNAL[:5]]),
        ((SIGNAL[:, 0], SIGNAL[:5, 0]), [SIGNAL[:, :1], SIGNAL[:5, :1]]),
        (np.stack([SIGNAL, SIGNAL + 1]), [SIGNAL, SIGNAL + 1]),
        (Table(SIGNAL, ["a", "b"]), [SIGNAL]),
        ([Table(SIGNAL, ["a", "b"])] * 2, [SIGNAL, SIGNAL]),
        (Column(SIGNAL[:, 0], "a"), [SIGNAL[:, :1]]),
    ],
)
def test_one_or_several_in_any_form_are_records(signal: Any, wanted: list[np.ndarray]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = side_of(signal, "input").records
    assert len(found) == len(wanted)
    for array, right in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(array, right)


def test_a_list_of_rows_is_one_record_and_not_many() -> None:
    assert [array.shape for array in side_of([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], "input").records] == [(3, 2)]


@pytest.mark.parametrize(
    ("columns", "names", "units"),
    [
        (["force [N]", "x (um)"], ("force", "x"), ("N", "um")),
        (["force", "x [m/s^2]"], ("force", "x"), ("1", "m/s^2")),
        (["a [V]", "a [A]"], ("a [V]", "a [A]"), ("1", "1")),
    ],
)
def test_names_and_units_are_those_of_the_columns(
    columns: list[str], names: tuple[str, ...], units: tuple[str, ...]
) -> None:
    side = side_of(Table(SIGNAL, columns), "input")
    assert (side.names, side.units) == (names, units)


def test_arrays_and_columns_without_a_name_have_none() -> None:
    for signal in (SIGNAL, Column(SIGNAL[:, 0], None)):
        assert side_of(signal, "input").names == ()
    assert side_of(Column(SIGNAL[:, 0], "speed (rpm)"), "input").units == ("rpm",)


@pytest.mark.parametrize("channels", [1, 2])
def test_a_record_on_its_side_is_turned_and_that_is_said(channels: int) -> None:
    signal = np.random.default_rng(1).standard_normal((channels, 1000))
    with pytest.warns(UserWarning, match=rf"input has shape \({channels}, 1000\): taken for {channels} channel"):
        (found,) = side_of(signal, "input").records
    np.testing.assert_array_equal(found, signal.T)


def test_samples_that_are_masked_are_missing() -> None:
    (found,) = side_of(np.ma.masked_greater(SIGNAL, 20), "input").records
    assert np.isnan(found[-1]).any()
    with pytest.raises(ValueError, match="input 2 of record 1 is not finite at sample 10"):
        as_records(np.ma.masked_greater(SIGNAL, 20), SIGNAL)


@pytest.mark.parametrize(
    ("drive", "response", "reason"),
    [
        ([], SIGNAL, "there is no record of input"),
        (["a", "b"], SIGNAL, "input is list of what are no numbers"),
        (SIGNAL, "y", "output is str of what are no numbers"),
        (SIGNAL, 3.0, r"output of record 1 has shape \(\)"),
        ([SIGNAL, SIGNAL[:, :1]], SIGNAL, r"input of record 2 has shape \(12, 1\), must be \(N, width\)"),
        (SIGNAL, SIGNAL[:7], r"inputs have \[12\] samples and outputs \[7\], must be as many in each record"),
        (SIGNAL[:, :0], SIGNAL, r"input of record 1 has shape \(12, 0\)"),
        ({"u": SIGNAL}, SIGNAL, "input is a mapping of u: give one of what it holds"),
    ],
)
def test_what_is_no_record_is_refused_by_name(drive: Any, response: Any, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        as_records(drive, response)
