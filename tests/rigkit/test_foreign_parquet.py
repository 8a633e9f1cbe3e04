"""Parquet tables of anybody's: their columns, their rate, and what makes them unreadable, said by name."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from ctlblocks.recording import Recording, RecordingError
from rigkit.export.parquet_file import write_recording
from rigkit.foreign_record import open_signals, read_channels, read_signals


def table(path: Path, **columns: object) -> Path:
    parquet.write_table(pa.table(columns), path)
    return path


def test_a_column_of_time_says_the_rate_and_is_no_signal(tmp_path: Path) -> None:
    time = np.arange(500) / 200.0
    path = table(tmp_path / "log.parquet", time=time, force=np.sin(time), count=np.arange(500))
    found = read_signals(path)
    assert found.rate == pytest.approx(200.0)
    assert found.names == ("force", "count")
    np.testing.assert_array_equal(found.data, np.column_stack([np.sin(time), np.arange(500)]))


def test_an_export_of_this_program_comes_back_bit_for_bit(tmp_path: Path) -> None:
    record = Recording(("x", "u"), ("m", "V"), 1234.5, np.random.default_rng(1).standard_normal((700_000, 2)))
    write_recording(tmp_path / "made.parquet", record)
    found = read_channels(tmp_path / "made.parquet", ["u", "x"], None)
    assert (found.names, found.units, found.rate) == (("u", "x"), ("V", "m"), 1234.5)
    np.testing.assert_array_equal(found.data, record.data[:, ::-1])


def test_a_rate_that_is_given_is_taken_where_the_file_says_none(tmp_path: Path) -> None:
    path = table(tmp_path / "log.parquet", a=np.arange(10.0))
    assert read_signals(path, 50.0).rate == 50.0
    with pytest.raises(RecordingError, match="does not say its rate: give that, or a column of time in s"):
        read_signals(path)


def test_a_rate_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    path = table(tmp_path / "log.parquet", time=np.arange(10) / 100.0, a=np.arange(10.0))
    with pytest.raises(RecordingError, match="100 samples/s, must be 50"):
        read_signals(path, 50.0)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"time": [0.0, 0.1, 0.4], "a": [1.0, 2.0, 3.0]}, "time does not rise in even steps"),
        ({"time": [0.0, 0.1, 0.2], "a": [1.0, None, 3.0]}, "channel 'a', sample 1: nan, must be finite"),
        ({"time": [0.0, 0.1, 0.2], "a": ["x", "y", "z"]}, "column a is of string, must be of numbers"),
        ({"time": [0.0, 0.1, 0.2], "a": [[1.0], [2.0], [3.0]]}, r"column a is of list.* must be of numbers"),
        ({"time": pa.array([], pa.float64()), "a": pa.array([], pa.float64())}, "holds no sample, must be frames >= 1"),
    ],
)
def test_a_table_that_is_no_measurement_is_refused_by_name(
    tmp_path: Path, columns: dict[str, object], said: str
) -> None:
    with pytest.raises(RecordingError, match=said):
        read_signals(table(tmp_path / "log.parquet", **columns))


def test_what_is_no_parquet_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "log.parquet"
    path.write_bytes(b"PAR1 and no more")
    with pytest.raises(RecordingError, match="not a readable Parquet file") as refused:
        open_signals(path)
    assert "\n" not in str(refused.value)
