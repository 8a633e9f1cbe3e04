"""Somebody's log in place of a run's recording: which of its columns is which of the run's channels."""

import difflib
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks.recording import Recording
from rigkit.foreign_record import open_signals

EACH = "CHANNEL=COLUMN, CHANNEL=COLUMN*FACTOR or CHANNEL==VALUE"


@dataclass(frozen=True)
class Column:
    """Where a channel comes from.

    Parameters
    ----------
    name : str
        Of a column, or its number from 1; empty where the channel always has the same value.
    factor : float
        The channel's unit per the column's; or that value.
    """

    name: str
    factor: float


def columns_of(texts: Sequence[str]) -> dict[str, Column]:
    """Read which channel comes from which column; several may stand in one text, with commas between.

    Parameters
    ----------
    texts : sequence of str
        Of `EACH`.

    Raises
    ------
    ValueError : it is none of these, or a channel is there twice.

    Examples
    --------
    >>> columns_of(["position_x=plate*1e-6,extension_x=2", "absolute_x==0"])["position_x"]
    Column(name='plate', factor=1e-06)
    """
    found: dict[str, Column] = {}
    for text in (part for each in texts for part in each.split(",")):
        channel, equals, column = (part.strip() for part in text.partition("="))
        if not channel or not equals or not column:
            raise ValueError(f"--map is {text!r}, must be {EACH}")
        if channel in found:
            raise ValueError(f"--map names {channel} twice, must be once")
        found[channel] = _column(text, column)
    return found


def record_of(
    path: Path,
    columns: Mapping[str, Column],
    like: Recording,
    made: Collection[str],
    rate: float | None = None,
) -> Recording:
    """Read a log as a recording with a run's channels.

    Parameters
    ----------
    path : Path
        As of `open_signals`.
    columns : mapping of str to Column
        By channel.
    like : Recording
        Of the run: its channels, their units, its rate.
    made : collection of str
        Channels that controllers make; these alone need no column.
    rate : float or None, samples/s
        Of the log, where that does not say it.

    Returns
    -------
    Recording
        The channels of `like` that have a column, in its order.

    Raises
    ------
    ValueError : a channel that the run has not, or one of its sensors without a column.
    RecordingError : as of `open_signals`; another rate or unit than the run's.
    """
    _refuse_unfit(columns, like, made)
    channels = [name for name in like.names if name in columns]
    read = list(dict.fromkeys(columns[name].name for name in channels if columns[name].name))
    if not read:
        raise ValueError(f"--map gives no channel a column of {path}")
    log = open_signals(path, rate, read).whole()
    if not math.isclose(log.rate, like.rate, rel_tol=1e-3):
        raise ValueError(
            f"{path}: {log.rate:.9g} samples/s, must be {like.rate:.9g} as the run: its controllers are made for that; "
            "resample it, or begin a run at the log's rate"
        )
    data, units = np.empty((len(log.data), len(channels))), dict(zip(like.names, like.units, strict=True))
    for place, name in enumerate(channels):
        column = columns[name]
        if not column.name:
            data[:, place] = column.factor
            continue
        at = read.index(column.name)
        _refuse_unit(path, column, log.units[at], units[name], name)
        data[:, place] = log.data[:, at] * column.factor
    return Recording(tuple(channels), tuple(units[name] for name in channels), like.rate, data, {"log": str(path)})


def _column(text: str, column: str) -> Column:
    if column.startswith("="):
        return Column("", _number(text, column[1:]))
    name, star, factor = column.rpartition("*")
    return Column(name.strip(), _number(text, factor)) if star else Column(column, 1.0)


def _number(text: str, number: str) -> float:
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"--map is {text!r}, whose {number.strip()!r} must be a number; must be {EACH}")
    return value


def _refuse_unfit(columns: Mapping[str, Column], like: Recording, made: Collection[str]) -> None:
    for name in columns:
        if name not in like.names:
            near = difflib.get_close_matches(name, like.names, 1)
            meant = f"; {near[0]}?" if near else ""
            raise ValueError(f"--map names {name}, must be a channel of the run: {', '.join(like.names)}{meant}")
    missing = [name for name in like.names if name not in columns and name not in made]
    if missing:
        raise ValueError(
            f"--map has no column for {', '.join(missing)}, which controllers read or the run was given: "
            f"must be {EACH} for each"
        )


def _refuse_unit(path: Path, column: Column, unit: str, wanted: str, name: str) -> None:
    if unit not in ("1", wanted) and column.factor == 1.0:
        raise ValueError(
            f"{path}: {column.name} is in {unit}, must be in {wanted} for {name}: --map {name}={column.name}*FACTOR"
        )
