"""Columns with their units as Apache Parquet, through pyarrow: for pandas, DuckDB, MATLAB and the like."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from rigkit.export.optional import optional

ABOUT = "vibrostage"
"""The key of the file's metadata under which JSON says what it holds and where it comes from."""
TIME = "time"
"""The column of a recording that counts seconds from its first sample."""


@dataclass(frozen=True)
class Column:
    """One column.

    Parameters
    ----------
    name, unit : str
    values : array, shape (rows,), in that unit
    """

    name: str
    unit: str
    values: np.ndarray


def write_table(path: Path, columns: Sequence[Column], about: Mapping[str, Any]) -> None:
    """Write columns, every value to its last bit; "unit" is in the metadata of each, `about` in that of the file.

    Parameters
    ----------
    path : Path
        Written in place.
    columns : sequence of Column, all of one length
    about : mapping, as JSON takes it

    Raises
    ------
    ValueError : pyarrow is not installed.
    """
    arrow, parquet = optional("pyarrow"), optional("pyarrow.parquet")
    arrays = [arrow.array(column.values) for column in columns]
    fields = [
        arrow.field(column.name, array.type, nullable=False, metadata={"unit": column.unit})
        for column, array in zip(columns, arrays, strict=True)
    ]
    table = arrow.Table.from_arrays(arrays, schema=arrow.schema(fields, metadata={ABOUT: json.dumps(about)}))
    parquet.write_table(table, path, compression="zstd", use_dictionary=False)


def write_recording(path: Path, record: Recording) -> None:
    """Write a recording: its time, s, from the first sample on, and a column a channel; its rate is in the metadata.

    Parameters
    ----------
    path : Path
        Written in place.
    record : Recording

    Raises
    ------
    ValueError : pyarrow is not installed, or a channel is called "time".
    """
    if TIME in record.names:
        raise ValueError(f"a channel is called {TIME!r}, as the column of time is")
    time = Column(TIME, "s", np.arange(len(record.data)) / record.rate)
    channels = (
        Column(name, unit, np.ascontiguousarray(values))
        for name, unit, values in zip(record.names, record.units, record.data.T, strict=True)
    )
    write_table(path, [time, *channels], {"rate": record.rate, "provenance": dict(record.provenance)})
