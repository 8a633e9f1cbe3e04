"""Records of inputs and outputs as people hand them over: one or several, checked before anything is computed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from calibration.warned import warn
from rigkit.column_titles import names_and_units

LARGEST, SMALLEST = 1e100, 1e-100
"""Of the largest value of a record, any unit: squares of others are no numbers."""
WIDE = 4
"""Times as many channels as samples that are taken for a record that lies on its side."""


@dataclass(frozen=True)
class Side:
    """The inputs, or the outputs, of some records.

    Parameters
    ----------
    records : list of arrays, each of shape (N, width), any unit
        Not finite where a sample is missing.
    names, units : tuples of strings
        Of the channels, as the columns of tables have them; empty where nothing tells.
    """

    records: list[np.ndarray]
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()


def as_records(drive: Any, response: Any) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return inputs and outputs as lists of arrays, record by record of one length, all of one width.

    Parameters
    ----------
    drive : array, shape (N, m) or (N,), or a sequence or a table of such, or several of them, any unit
        See `side_of`.
    response : array, shape (N, p) or (N,), or a sequence or a table of such, or several of them, any unit

    Returns
    -------
    drives, responses : lists of arrays, shapes (N, m) and (N, p)

    Raises
    ------
    ValueError : another shape, lengths that differ, or a value that is not finite.
    """
    inputs, outputs = sides_of(drive, response)
    for name, side in (("input", inputs), ("output", outputs)):
        for number, array in enumerate(side.records):
            if not np.isfinite(array).all():
                sample, channel = np.argwhere(~np.isfinite(array))[0]
                raise ValueError(f"{name} {channel + 1} of record {number + 1} is not finite at sample {sample}")
    return inputs.records, outputs.records


def sides_of(drive: Any, response: Any) -> tuple[Side, Side]:
    """Return both sides of some records, of which samples may be missing.

    Parameters
    ----------
    drive, response
        As of `as_records`; no drive where there are no inputs, which then have no channels.

    Raises
    ------
    ValueError : another shape, or lengths that differ.
    """
    heard = side_of(response, "output")
    given = side_of(drive, "input") if drive is not None else Side([np.zeros((len(each), 0)) for each in heard.records])
    sides = given, heard
    inputs, outputs = ([len(each) for each in side.records] for side in sides)
    if inputs != outputs:
        raise ValueError(f"inputs have {inputs} samples and outputs {outputs}, must be as many in each record")
    return sides


def side_of(signal: Any, name: str) -> Side:
    """Return one side of some records.

    Parameters
    ----------
    signal : array, shape (N, width) or (N,), list of numbers, pandas or polars table or column, or several of them
        One record, or several in a list, a tuple or an array of three axes; a list of lists of numbers has the rows of
        one.  A record with many more columns than rows is taken to lie on its side, which is said in a warning.
    name : str
        For errors: "input" or "output".

    Raises
    ------
    ValueError : what is no signal, or widths that differ.
    """
    parts = list(signal) if _are_several(signal) else [signal]
    if not parts:
        raise ValueError(f"there is no record of {name}")
    records = [_upright(_values(part, name), name) for part in parts]
    for number, array in enumerate(records):
        if array.ndim != 2 or array.shape[1] != records[0].shape[-1] or not array.shape[1]:
            raise ValueError(
                f"{name} of record {number + 1} has shape {array.shape}, must be (N, width), all of one width"
            )
    if (size := _size(records)) and not SMALLEST <= size <= LARGEST:
        raise ValueError(f"{name} is as large as {size:g}, must be {SMALLEST:g} to {LARGEST:g}: take another unit")
    return Side(records, *_words(parts[0], records[0].shape[1]))


def _size(records: list[np.ndarray]) -> float:
    """Return the largest value that is there, 0 where there is none."""
    return max((float(np.max(np.abs(each), initial=0.0, where=np.isfinite(each))) for each in records), default=0.0)


def _are_several(signal: Any) -> bool:
    """Say whether a signal is a sequence of records; lists of lists of numbers are the rows of one."""
    if isinstance(signal, np.ndarray):
        return signal.ndim == 3
    if not isinstance(signal, list | tuple) or not signal:
        return isinstance(signal, list | tuple)
    first = signal[0]
    return hasattr(first, "to_numpy") or (isinstance(first, np.ndarray) and first.ndim > 0) or _depth(first) > 1


def _depth(item: Any) -> int:
    """Count how deep lists lie in one another."""
    return 1 + _depth(item[0]) if isinstance(item, list | tuple) and item else 0


def _values(part: Any, name: str) -> np.ndarray:
    """Return the numbers of a record, of any shape; missing ones are not finite."""
    if isinstance(part, Mapping):
        names = [str(key) for key in part if not str(key).startswith("__")]
        raise ValueError(f"{name} is a mapping of {', '.join(names[:9]) or 'nothing'}: give one of what it holds")
    if part is None:
        raise ValueError(f"{name} is None, must be an array (N, width) or (N,)")
    values = part.to_numpy() if hasattr(part, "to_numpy") else part
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(float), np.nan)
    if np.iscomplexobj(values):
        raise ValueError(f"{name} has complex numbers, must be real")
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {type(part).__name__} of what are no numbers, must be an array of them") from None


def _upright(array: np.ndarray, name: str) -> np.ndarray:
    """Return a record as (N, width)."""
    if array.ndim == 1:
        return array[:, None]
    if array.ndim == 2 and array.shape[1] > WIDE * array.shape[0]:
        channels, samples = array.shape
        warn(
            f"{name} has shape {array.shape}: taken for {channels} channel{'s' * (channels > 1)} of {samples} samples, "
            f"not for {samples} channels of {channels} sample{'s' * (channels > 1)}"
        )
        return np.ascontiguousarray(array.T)
    return array


def _words(part: Any, width: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of a table's columns: "force [N]" or "force (N)"."""
    columns = getattr(part, "columns", None)
    if columns is None:
        columns = [part.name] if getattr(part, "name", None) is not None and hasattr(part, "to_numpy") else []
    titles = [str(column) for column in columns]
    if len(titles) != width or len(set(titles)) != width:
        return (), ()
    names, units = names_and_units(titles)
    return (names, units) if len(set(names)) == width else (tuple(titles), ("1",) * width)
