"""The variables of a file of arrays, whichever library reads it: which are signals, time, or a rate."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rigkit.array_room import let_have
from rigkit.even_time import STEADY, EvenTime, seconds_of
from rigkit.foreign_stream import frames_at_once

RATES = ("rate", "fs", "f_s", "fsamp", "samplerate", "sample_rate", "samplingrate", "sampling_rate")
"""Names, in small letters, of a number that is the rate, samples/s."""
PERIODS = ("ts", "t_s", "dt", "delta_t", "sample_period", "sampling_period")
"""Names, in small letters, of a number that is the time between samples, s."""
WIDEST = 1024
"""Columns of a variable."""


class RefusedError(ValueError):
    """What is wrong with a file, in words."""


@dataclass(frozen=True)
class Variable:
    """An array of a file in one or two dimensions, time along the first.

    Parameters
    ----------
    name : str
    frames, width : int
    read : callable(start, stop) -> array, shape (stop - start, width), any unit
    unit : str
    rate : anything
        What the file says of it; None for nothing.
    grain : int, frames
        How many are read at once with any of them.
    """

    name: str
    frames: int
    width: int
    read: Callable[[int, int], np.ndarray]
    unit: str = "1"
    rate: Any = None
    grain: int = 1

    def __post_init__(self) -> None:
        """Refuse what has channels along its first axis."""
        if self.frames and self.width > min(self.frames, WIDEST):
            raise RefusedError(
                f"{self.name} is {self.frames} x {self.width}, must have time along its first axis and at most {WIDEST}"
                " columns: transpose it"
            )

    @property
    def own_name(self) -> str:
        """Its name without the groups that it is in."""
        return self.name.rpartition("/")[2]


@dataclass
class Contents:
    """What is in a file.

    Parameters
    ----------
    variables : list of Variable
    numbers : dict of str to anything
        Single numbers, and attributes of the whole file, by name.
    others : list of str
        What else there is, for errors.
    """

    variables: list[Variable] = field(default_factory=list)
    numbers: dict[str, Any] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)


Column = tuple[str, Variable, int]
"""A channel's name, its variable and which of its columns it is, from 0."""


def chosen(found: Contents, channels: Sequence[str] | None) -> list[Column]:
    """Return the channels that are asked for.

    Parameters
    ----------
    found : Contents
    channels : sequence of str or None
        As of `rigkit.foreign_record.open_signals`.

    Raises
    ------
    RefusedError : one is not in the file, or there is none, or they differ in length.
    """
    every = [column for variable in found.variables if not _is_time(variable) for column in _columns(variable)]
    if channels is not None:
        every = [_named(found, every, channel) for channel in channels]
    if not every:
        there = [variable.name for variable in found.variables] + found.others
        raise RefusedError(f"holds no signals: no arrays of real numbers, but {', '.join(there) or 'nothing'}")
    lengths = {variable.name: variable.frames for _, variable, _ in every}
    if len(set(lengths.values())) > 1:
        differing = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise RefusedError(f"the signals have different lengths, {differing}")
    return every


def rate_of(found: Contents, columns: Sequence[Column]) -> float | None:
    """Return the rate that a file says, samples/s, or None: by attributes and numbers, or by a variable of time.

    Parameters
    ----------
    found : Contents
    columns : sequence of Column
        The channels that are asked for.

    Raises
    ------
    RefusedError : it says several, or something that is none.
    RecordingError : its time does not rise evenly.
    """
    said: dict[str, float] = {}
    for _, variable, _ in columns:
        if variable.rate is not None:
            said[f"rate of {variable.name}"] = _number("rate", variable.rate)
    for name, value in found.numbers.items():
        plain = name.rpartition("/")[2].lower()
        if plain in RATES:
            said[name] = _number(name, value)
        elif plain in PERIODS:
            said[name] = 1 / _number(name, value)
    frames = columns[0][1].frames
    for variable in found.variables:
        if _is_time(variable) and variable.frames == frames:
            said[variable.name] = _by_time(variable)
    rates = list(said.values())
    if any(not abs(rate - rates[0]) <= STEADY * rates[0] for rate in rates):
        listed = ", ".join(f"{rate:.9g} by {name!r}" for name, rate in said.items())
        raise RefusedError(f"says several rates, {listed} samples/s: they must agree")
    return rates[0] if rates else None


def _columns(variable: Variable) -> list[Column]:
    if variable.width == 1:
        return [(variable.name, variable, 0)]
    return [(f"{variable.name}_{number + 1}", variable, number) for number in range(variable.width)]


def _named(found: Contents, every: Sequence[Column], channel: str) -> Column:
    """Return the channel of a name, a name with ":" and a column's number, or a number from 1."""
    place, _, number = channel.partition(":")
    for variable in found.variables:
        if variable.name == place.strip("/"):
            number = number or ("1" if variable.width == 1 else "")
            if not (number.isdecimal() and 1 <= int(number) <= variable.width):
                raise RefusedError(f"{channel!r} must name one of {variable.width} columns, as {place}:1")
            return channel, variable, int(number) - 1
    for name, variable, column in every:
        if name == channel:
            return channel, variable, column
    if channel.isdecimal() and 1 <= int(channel) <= len(every):
        return every[int(channel) - 1]
    there = ", ".join([variable.name for variable in found.variables] + found.others)
    raise RefusedError(f"no dataset {place!r} of numbers in one or two dimensions; there are {there}")


def _is_time(variable: Variable) -> bool:
    return variable.width == 1 and seconds_of(variable.own_name, "1") is not None


def _by_time(variable: Variable) -> float:
    scale = seconds_of(variable.own_name, variable.unit)
    if scale is None:
        raise RefusedError(f"{variable.name!r} is in {variable.unit}, must be in s, ms, us or ns")
    time, size = EvenTime(repr(variable.name), scale, "sample"), frames_at_once(1)
    for start in range(0, variable.frames, size):
        stop = min(start + size, variable.frames)
        let_have(8 * max(size, variable.grain))
        time.follow(np.arange(start, stop), variable.read(start, stop)[:, 0].astype(float))
    return time.rate()


def _number(name: str, value: Any) -> float:
    try:
        number = float(np.asarray(value).item())
    except (ValueError, TypeError):
        raise RefusedError(f"its {name} is {value!r}, must be a number of samples/s") from None
    if not 0 < number < np.inf:
        raise RefusedError(f"its {name} is {number:g}, must be finite and > 0")
    return number
