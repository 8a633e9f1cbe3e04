"""Drives and responses from a file of anybody's, in V and m/s^2."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.even_time import STEADY
from rigkit.foreign_record import is_sound, open_signals
from rigkit.foreign_stream import Signals
from vibractl.config import Audio

UNITS = {
    "V": {"V": 1.0, "mV": 1e-3, "kV": 1e3},
    "m/s^2": {"m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "m/s/s": 1.0, "mm/s^2": 1e-3, "g": 9.80665, "mg": 9.80665e-3},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "uPa": 1e-6},
}
"""What one of a file's units is in ours."""


@dataclass(frozen=True)
class Kind:
    """What some channels of a file hold.

    Parameters
    ----------
    name : str
        Their name in a recording of this program, before the number.
    width : int
        How many there must be.
    unit : str
    full_scale : float, the unit's
        What the number 1 of a sound file stands for.
    """

    name: str
    width: int
    unit: str
    full_scale: float


def drives_of(audio: Audio) -> Kind:
    """Return what a rig's drives are."""
    return Kind("drive", len(audio.drive_channels), "V", audio.output_full_scale)


def responses_of(audio: Audio) -> Kind:
    """Return what a rig's responses are."""
    return Kind("response", len(audio.response_channels), "m/s^2", audio.input_full_scale)


def open_kind(path: Path, kind: Kind, rate: float, is_mapped: bool = False) -> Signals:
    """Open all signals of one kind in a file that holds them, by name or because it holds nothing else.

    Numbers without a unit are parts of full scale in a sound, else in the kind's unit.

    Parameters
    ----------
    path : Path
        As of `rigkit.foreign_record.open_signals`.
    kind : Kind
    rate : float, samples/s
        Which the file must have.
    is_mapped : bool
        Whether who calls takes a map of channels, for the error.

    Returns
    -------
    Signals
        In the kind's unit.

    Raises
    ------
    RecordingError : it names the file, what is in it and what must be.
    """
    found, _ = opened(path, rate)
    named = [f"{kind.name}_{number + 1}" for number in range(kind.width)]
    if set(named) <= set(found.names):
        found = found.select(named)
    elif len(found.names) != kind.width:
        hint = f"; --map {named[0]}=CHANNEL,... says which they are" if is_mapped else ""
        raise RecordingError(
            f"{path}: {len(found.names)} channels ({', '.join(found.names)}), must be {kind.width}, one for each "
            f"{kind.name}, or have channels named {', '.join(named)}{hint}"
        )
    return found.scaled(kind.unit, scales_of(found, kind))


def opened(path: Path, rate: float, channels: Sequence[str] | None = None) -> tuple[Signals, bool]:
    """Open a file that has the rig's rate, or says none; and whether it says one.

    Parameters
    ----------
    path : Path
    rate : float, samples/s
    channels : sequence of str, optional
        As of `rigkit.foreign_record.open_signals`.

    Raises
    ------
    RecordingError : another rate, or as of `open_signals`.
    """
    try:
        found, says_rate = open_signals(path, None, channels), True
    except RecordingError:
        found, says_rate = open_signals(path, rate, channels), False
    if not abs(found.rate - rate) <= STEADY * rate:
        raise RecordingError(
            f"{path}: {found.rate:.9g} samples/s, must be audio.rate, {rate:.9g}: nothing is resampled in silence, "
            f"--set audio.rate={found.rate:.0f} processes it at its own rate"
        )
    return found, says_rate


def scales_of(found: Signals, kind: Kind) -> np.ndarray:
    """Return what the number 1 stands for in signals of a kind, (channels,), the kind's unit.

    Parameters
    ----------
    found : Signals
    kind : Kind

    Raises
    ------
    RecordingError : a channel has a unit that cannot be.
    """
    known = UNITS[kind.unit]
    bare = kind.full_scale if is_sound(found.path) else 1.0
    for name, unit in zip(found.names, found.units, strict=True):
        if unit not in known and unit != "1":
            raise RecordingError(
                f"{found.path}: channel {name!r} is in {unit}, must be in {', '.join(known)}, or a part of full scale"
            )
    return np.array([bare if unit == "1" else known[unit] for unit in found.units])


def read_kind(path: Path, kind: Kind, rate: float) -> np.ndarray:
    """Read all signals of one kind, whole.

    Parameters
    ----------
    path : Path
    kind : Kind
    rate : float, samples/s

    Returns
    -------
    array, shape (samples, width), the kind's unit

    Raises
    ------
    RecordingError : as of `open_kind`, and what is found while it is read.
    """
    return open_kind(path, kind, rate).whole().data
