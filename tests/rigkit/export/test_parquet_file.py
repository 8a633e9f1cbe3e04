"""Columns as Parquet, read back by pyarrow."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from ctlblocks.recording import Recording
from rigkit.export.parquet_file import Column, write_recording, write_table
from tests.rigkit.export.test_mcap_file import noise


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_recording_comes_back_bit_for_bit_with_time_units_rate_and_provenance(tmp_path: Path, dtype: str) -> None:
    record = noise(3, dtype, 44_100)
    write_recording(tmp_path / "x.parquet", record)
    table = pyarrow.parquet.read_table(tmp_path / "x.parquet")
    assert table.column_names == ["time", *record.names]
    assert [table.field(name).metadata[b"unit"].decode() for name in record.names] == list(record.units)
    data = np.column_stack([table[name].to_numpy() for name in record.names])
    assert data.dtype == dtype
    assert data.tobytes() == record.data.tobytes()
    np.testing.assert_allclose(table["time"].to_numpy(), np.arange(50) / 44_100, rtol=1e-15)
    about = json.loads(table.schema.metadata[b"vibrostage"])
    assert about == {"rate": 44_100.0, "provenance": {"rig": "x"}}


def test_columns_may_hold_anything_of_one_length(tmp_path: Path) -> None:
    columns = [Column("frequency", "Hz", np.array([1.0, 2.0])), Column("shots", "1", np.array([3, 4]))]
    write_table(tmp_path / "x.parquet", columns, {"bins": 2})
    table = pyarrow.parquet.read_table(tmp_path / "x.parquet")
    assert table.to_pydict() == {"frequency": [1.0, 2.0], "shots": [3, 4]}


def test_a_channel_called_time_is_refused(tmp_path: Path) -> None:
    record = Recording(("time",), ("s",), 10, np.zeros((3, 1)))
    with pytest.raises(ValueError, match="a channel is called 'time', as the column of time is"):
        write_recording(tmp_path / "x.parquet", record)
