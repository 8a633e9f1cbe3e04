"""Channels of a file that are drives, responses or monitors of the drives, by name or number, in V and m/s^2."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.foreign_arrays import SUFFIXES
from rigkit.foreign_record import is_sound
from rigkit.foreign_stream import Signals
from vibractl.foreign.signals import Kind, open_kind, opened, scales_of

BLOCK = 2**16
"""Samples that are read at once, of every file: drives and responses lie beside each other."""
_KEY = re.compile(r"(drive|response|monitor)_[1-9]\d*")


@dataclass(frozen=True, eq=False)
class Track:
    """Channels of a file, kind after kind, to be read block by block.

    Parameters
    ----------
    signals : Signals
    scale : array, shape (channels,), each one's unit
        What the number 1 stands for; negative where a channel is to be turned round.
    full_scale : array, shape (channels,), each one's unit
        The largest size that a file can hold; infinite where it says none.
    frames : int, samples
    says_rate : bool
        Whether the file itself does.
    """

    signals: Signals
    scale: np.ndarray
    full_scale: np.ndarray
    frames: int
    says_rate: bool

    @property
    def path(self) -> Path:
        """Of the file."""
        return self.signals.path

    def blocks(self, size: int = BLOCK) -> Iterator[np.ndarray]:
        """Read from the first sample to the last: arrays (at most `size`, channels), V or m/s^2."""
        return (block * self.scale for block in self.signals.blocks(size))


def parsed_map(text: str | None) -> dict[str, str]:
    """Return which channel is which, as `--map drive_1=3,response_1=accel_left,response_2=-5` says it.

    Parameters
    ----------
    text : str or None

    Raises
    ------
    ValueError : it is written otherwise, or says something twice.

    Examples
    --------
    >>> parsed_map("drive_1=3, response_1=-accel left")
    {'drive_1': '3', 'response_1': '-accel left'}
    """
    given: dict[str, str] = {}
    for part in (text or "").split(","):
        key, equals, channel = (each.strip() for each in part.partition("="))
        if not part.strip():
            continue
        if not (equals and channel.removeprefix("-") and _KEY.fullmatch(key)):
            raise ValueError(
                f"--map has {part.strip()!r}, must be drive_N, response_N or monitor_N, and =CHANNEL by name or number"
            )
        if key in given or channel.removeprefix("-") in [each.removeprefix("-") for each in given.values()]:
            raise ValueError(f"--map has {part.strip()!r}, but {key} or that channel is there already")
        given[key] = channel
    return given


def open_track(path: Path, kinds: Sequence[Kind], rate: float, given: Mapping[str, str]) -> Track:
    """Open a file and find its channels.

    Parameters
    ----------
    path : Path
    kinds : sequence of Kind
        What it must hold, in the order that is wanted.
    rate : float, samples/s
        Of the rig.
    given : mapping of str to str
        Channels by what they are, as of `parsed_map`; else they have these names, or the file holds nothing else.

    Raises
    ------
    RecordingError : no such file or channel, another rate, too many or too few channels, units that cannot be.
    """
    names = [given.get(name, "") for kind in kinds for name in _names(kind)]
    found, says_rate = _opened(path, rate, names if all(names) else None)
    parts = [_channels(found, kind, given, is_alone=len(kinds) == 1) for kind in kinds]
    chosen = found.select([name for names, _ in parts for name in names])
    scales, bounds = [], []
    for kind, (names, signs) in zip(kinds, parts, strict=True):
        own = found.select(names)
        scale = scales_of(own, kind)
        scales.append(signs * scale)
        bounds.append(np.where(is_sound(path) & np.array([unit == "1" for unit in own.units]), scale, np.inf))
    frames = found.frames if found.frames is not None else sum(map(len, found.blocks()))
    return Track(chosen, np.concatenate(scales), np.concatenate(bounds), frames, says_rate)


def open_mapped(path: Path, kind: Kind, rate: float, given: Mapping[str, str]) -> Signals:
    """Open all signals of one kind in a file, by a map where one is given for that kind.

    Parameters
    ----------
    path, kind, rate : as of `vibractl.foreign.signals.open_kind`
    given : mapping of str to str
        As of `parsed_map`; what it says of other kinds is for other files.

    Returns
    -------
    Signals
        In the kind's unit.

    Raises
    ------
    RecordingError : as of `open_track`.
    """
    if not any(name.startswith(f"{kind.name}_") for name in given):
        return open_kind(path, kind, rate, is_mapped=True)
    wanted = [given.get(name, "") for name in _names(kind)]
    found, _ = _opened(path, rate, wanted if all(wanted) else None)
    names, signs = _channels(found, kind, given, is_alone=True)
    chosen = found.select(names)
    return chosen.scaled(kind.unit, signs * scales_of(chosen, kind))


def has_all(path: Path, kind: Kind, given: Mapping[str, str], rate: float) -> bool:
    """Whether a file has channels of a kind, by map or by name."""
    names = _names(kind)
    if any(name in given for name in names):
        return True
    return path.suffix.lower() not in SUFFIXES and set(names) <= set(_opened(path, rate, None)[0].names)


def _opened(path: Path, rate: float, channels: Sequence[str] | None) -> tuple[Signals, bool]:
    """Open a file; whether it says its rate.  Of arrays, which may have other lengths, only those that are wanted."""
    wanted = None
    if channels is not None and path.suffix.lower() in SUFFIXES:
        wanted = [channel.removeprefix("-") for channel in channels]
    return opened(path, rate, wanted)


def _names(kind: Kind) -> list[str]:
    return [f"{kind.name}_{number + 1}" for number in range(kind.width)]


def _channels(found: Signals, kind: Kind, given: Mapping[str, str], is_alone: bool) -> tuple[list[str], np.ndarray]:
    """Return the names of a kind's channels, and the sign of each."""
    wanted = _names(kind)
    mapped = [name for name in given if name.startswith(f"{kind.name}_")]
    if mapped and set(mapped) != set(wanted):
        raise RecordingError(
            f"{found.path}: --map has {', '.join(sorted(mapped))}, must have {', '.join(wanted)}, one for each "
            f"{kind.name} of the rig file"
        )
    if mapped:
        names = [_named(found, given[name].removeprefix("-")) for name in wanted]
        return names, np.array([-1.0 if given[name].startswith("-") else 1.0 for name in wanted])
    if set(wanted) <= set(found.names):
        return wanted, np.ones(kind.width)
    if is_alone and len(found.names) == kind.width:
        return list(found.names), np.ones(kind.width)
    raise RecordingError(
        f"{found.path}: {len(found.names)} channels ({', '.join(found.names)}), must have {', '.join(wanted)}"
        f"{f', or be {kind.width} alone' if is_alone else ''}; --map {wanted[0]}=CHANNEL,... says which they are"
    )


def _named(found: Signals, channel: str) -> str:
    """Return the name of a channel by name, or by its number in the file, a column of time counted."""
    if channel in found.names:
        return channel
    if channel.isdecimal() and int(channel) - 1 in found.columns:
        return found.names[found.columns.index(int(channel) - 1)]
    there = ", ".join(f"{column + 1} {name}" for column, name in zip(found.columns, found.names, strict=True))
    raise RecordingError(f"{found.path}: no channel {channel!r}; there are {there}")
