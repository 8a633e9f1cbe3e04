"""Parquet tables of anybody's as signals, through pyarrow: columns of numbers, and a rate or a column of time."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.even_time import EvenTime, seconds_of
from rigkit.export.optional import optional
from rigkit.export.parquet_file import ABOUT
from rigkit.foreign_stream import Signals, frames_at_once

SUFFIXES = (".parquet",)


def parquet_signals(path: Path, rate: float | None) -> Signals:
    """Open a Parquet file.

    Parameters
    ----------
    path : Path
    rate : float or None, samples/s
        Where the file says none.

    Raises
    ------
    RecordingError : no such table, a column that is none of numbers, or no rate.
    ValueError : pyarrow is not installed.
    """
    arrow, parquet = optional("pyarrow"), optional("pyarrow.parquet")
    try:
        file = parquet.ParquetFile(path)
    except (OSError, arrow.ArrowInvalid) as fault:
        raise RecordingError(f"{path}: not a readable Parquet file ({' '.join(str(fault).split())})") from None
    fields = list(file.schema_arrow)
    for field in fields:
        if not (arrow.types.is_integer(field.type) or arrow.types.is_floating(field.type)):
            raise RecordingError(f"{path}: column {field.name} is of {field.type}, must be of numbers")
    names = tuple(field.name for field in fields)
    units = tuple((field.metadata or {}).get(b"unit", b"1").decode() for field in fields)

    def source() -> Iterator[np.ndarray]:
        for batch in file.iter_batches(batch_size=frames_at_once(max(1, len(names)))):
            yield np.column_stack([np.asarray(column.to_numpy(zero_copy_only=False), float) for column in batch])

    found = Signals(path, names, units, 1.0, file.metadata.num_rows, source, tuple(range(len(names))))
    said = _said(file) or _by_time(found) or rate
    if said is None:
        raise RecordingError(f"{path}: does not say its rate: give that, or a column of time in s")
    return replace(found, rate=said)


def _said(file: Any) -> float | None:
    about = (file.schema_arrow.metadata or {}).get(ABOUT.encode())
    try:
        return float(json.loads(about)["rate"]) if about is not None else None
    except (ValueError, KeyError, TypeError):
        return None


def _by_time(found: Signals) -> float | None:
    """Return the rate that a column of time says; None where there is none."""
    for place, (name, unit) in enumerate(zip(found.names, found.units, strict=True)):
        scale = seconds_of(name, unit)
        if scale is not None:
            time, done = EvenTime(f"{found.path}: {name}", scale, "row"), 0
            for part in found.source():
                time.follow(np.arange(done + 1, done + 1 + len(part)), part[:, place])
                done += len(part)
            return time.rate()
    return None
