"""Recordings that anybody made as inputs and outputs: in one file, or drives and responses in two, pair by pair."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from calibration.gaps import without_gaps
from calibration.subspace.outliers import Outliers, outlier_notes, treated
from ctlblocks.recording import Recording, RecordingError
from rigkit.even_time import STEADY
from rigkit.foreign_record import open_signals, read_channels

UNLIKE = 0.5
"""Of the longer file, by which drives and responses may differ in length: more is no pair."""


@dataclass(frozen=True)
class Measured:
    """Recordings of one rate, with the same channels.

    Parameters
    ----------
    recordings : tuple of Recording
        Inputs first.
    names : tuple of str
        Of each, for people: its file or files.
    inputs : int
    is_apart : tuple of bool
        Of each, whether inputs and outputs come from two files.
    notes : tuple of str
        What a person should know of them.
    """

    recordings: tuple[Recording, ...]
    names: tuple[str, ...]
    inputs: int
    is_apart: tuple[bool, ...]
    notes: tuple[str, ...] = ()

    @property
    def samples(self) -> int:
        """Of all recordings."""
        return sum(len(each.data) for each in self.recordings)

    @property
    def source(self) -> str:
        """All files."""
        return ", ".join(dict.fromkeys(self.names))


def from_file(
    path: Path, inputs: Sequence[str], outputs: Sequence[str], rate: float | None, at_least: int = 1
) -> Measured:
    """Read inputs and outputs from one file; where samples are missing a recording ends, and another one begins.

    Parameters
    ----------
    path : Path
    inputs, outputs : sequences of str
        Channels, by name or number.
    rate : float or None, samples/s
        Where the file does not say it.
    at_least : int, samples, optional
        Shorter stretches between samples that are missing are left out.

    Raises
    ------
    RecordingError : as of `read_channels`.
    ValueError : a channel that is both, or has no sample, or no stretch that is long enough.
    """
    if both := set(inputs) & set(outputs):
        raise ValueError(f"{', '.join(sorted(both))}: cannot be input and output at once")
    recording = read_channels(path, [*inputs, *outputs], rate, may_miss=True)
    try:
        return _without_gaps(recording, str(path), len(inputs), at_least)
    except ValueError as fault:
        raise ValueError(f"{path}: {fault}") from None


def _without_gaps(recording: Recording, name: str, inputs: int, at_least: int) -> Measured:
    """Return the stretches of a recording in which no sample is missing, and say what is left out."""
    for channel, signal in zip(recording.names, recording.data.T, strict=True):
        if np.isnan(signal).all():
            raise ValueError(f"channel {channel!r} has no sample")
    drive, response = np.hsplit(recording.data, [inputs])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        pieces = list(zip(*without_gaps([drive], [response], at_least=at_least), strict=True))
    found = tuple(replace(recording, data=np.hstack(piece)) for piece in pieces)
    return Measured(
        found, (name,) * len(found), inputs, (False,) * len(found), tuple(str(each.message) for each in told)
    )


def from_pairs(
    drives: Sequence[Path], responses: Sequence[Path], given: Mapping[str, str], rate: float | None
) -> Measured:
    """Read pairs of files, one of the drives, one of the responses; both may be the same file.

    Parameters
    ----------
    drives, responses : sequences of Path, as many of one as of the other
    given : mapping of str to str
        Channels by what they are, "drive_1" or "response_2", as of `vibractl.foreign.tracks.parsed_map`.  Where there
        are none: channels of these names, else all of the file.
    rate : float or None, samples/s
        Where the files do not say it.

    Raises
    ------
    RecordingError : a file that cannot be read, or does not fit the others.
    """
    if len(drives) != len(responses):
        raise ValueError(
            f"--from has {len(drives)} drives and {len(responses)} responses, must be a pair each time: "
            "--from D.wav R.wav"
        )
    if monitors := [name for name in given if name.startswith("monitor")]:
        raise ValueError(f"--map has {monitors[0]}, must have drive_N and response_N: a monitor is a drive here")
    read: list[Recording] = []
    notes: list[str] = []
    inputs = 0
    for drive, response in zip(drives, responses, strict=True):
        sides = _side(drive, "drive", given, rate), _side(response, "response", given, rate)
        if drive == response and set(sides[0].names) & set(sides[1].names):
            raise RecordingError(
                f"{drive}: has channels {', '.join(sides[0].names)}, which are drives and which are responses must be "
                "said: --map drive_1=1,response_1=2,..."
            )
        recording, unused = _beside(drive, response, *sides)
        notes += unused
        inputs = inputs or len(sides[0].names)
        if read:
            if len(sides[0].names) != inputs:
                raise RecordingError(f"{drive}: {len(sides[0].names)} drives, must be {inputs}, as {drives[0]} has")
            _refuse_unlike(recording, read[0], f"{drive} and {response}", str(drives[0]))
        read.append(replace(recording, names=read[0].names) if read else recording)
    names = tuple(_name(*pair) for pair in zip(drives, responses, strict=True))
    apart = tuple(drive != response for drive, response in zip(drives, responses, strict=True))
    return Measured(tuple(read), names, inputs, apart, tuple(notes))


def without_outliers(measured: Measured, outliers: Outliers) -> Measured:
    """Return recordings without single samples of outputs that are far off, and say how many those were.

    Parameters
    ----------
    measured : Measured
    outliers : "replace" or "keep"

    Raises
    ------
    ValueError : another word.
    """
    drives, responses = zip(*(np.hsplit(each.data, [measured.inputs]) for each in measured.recordings), strict=True)
    cleaned, found = treated(drives, responses, outliers)
    data = (np.hstack(pair) for pair in zip(drives, cleaned, strict=True))
    recordings = tuple(replace(each, data=both) for each, both in zip(measured.recordings, data, strict=True))
    return replace(measured, recordings=recordings, notes=(*measured.notes, *outlier_notes(found)))


def _side(path: Path, kind: str, given: Mapping[str, str], rate: float | None) -> Recording:
    """Read the channels of one kind."""
    mapped = [name for name in given if name.startswith(f"{kind}_")]
    wanted = [f"{kind}_{number + 1}" for number in range(len(mapped))]
    if set(mapped) != set(wanted):
        raise ValueError(f"--map has {', '.join(sorted(mapped))}, must have {', '.join(wanted)}: numbers from 1 on")
    if mapped:
        channels = [given[name] for name in wanted]
        read = open_signals(path, rate, [each.removeprefix("-") for each in channels], "--rate says").whole()
        return replace(read, data=read.data * [-1.0 if each.startswith("-") else 1.0 for each in channels])
    found = open_signals(path, rate, None, "--rate says")
    own = sorted((name for name in found.names if _is_of(name, kind)), key=lambda name: int(name.rpartition("_")[2]))
    return (found.select(own) if own else found).whole()


def _is_of(name: str, kind: str) -> bool:
    word, _, number = name.rpartition("_")
    return word == kind and number.isdecimal()


def _beside(drive: Path, response: Path, sent: Recording, heard: Recording) -> tuple[Recording, list[str]]:
    """Put drives and responses beside each other; say what of the longer file is not used."""
    if not abs(heard.rate - sent.rate) <= STEADY * sent.rate:
        raise RecordingError(f"{response}: {heard.rate:.9g} samples/s, must be {sent.rate:.9g}, as {drive} has")
    lengths = len(sent.data), len(heard.data)
    common, longest = min(lengths), max(lengths)
    if longest - common > UNLIKE * longest:
        raise RecordingError(f"{response}: {lengths[1]} samples, {drive} has {lengths[0]}, must be nearly as many")
    longer = drive if lengths[0] > lengths[1] else response
    unused = [f"{longer}: the last {longest - common} samples have none beside them and are left out"]
    names = sent.names, heard.names
    if set(names[0]) & set(names[1]):
        names = _numbered("drive", len(names[0])), _numbered("response", len(names[1]))
    data = np.hstack((sent.data[:common], heard.data[:common]))
    about = {**sent.provenance, **heard.provenance}
    joined = Recording(names[0] + names[1], sent.units + heard.units, sent.rate, data, about)
    return joined, unused if longest > common else []


def _numbered(kind: str, width: int) -> tuple[str, ...]:
    return tuple(f"{kind}_{number + 1}" for number in range(width))


def _refuse_unlike(recording: Recording, first: Recording, name: str, other: str) -> None:
    """Refuse a recording that is no other experiment on what the first one is of."""
    if not abs(recording.rate - first.rate) <= STEADY * first.rate:
        raise RecordingError(
            f"{name}: {recording.rate:.9g} samples/s, must be {first.rate:.9g}, as {other} has: resample them, or "
            "identify them by themselves"
        )
    if len(recording.names) != len(first.names):
        raise RecordingError(f"{name}: {len(recording.names)} channels, must be {len(first.names)}, as {other} has")
    for number, (unit, must) in enumerate(zip(recording.units, first.units, strict=True)):
        if unit != must:
            raise RecordingError(f"{name}: {recording.names[number]!r} is in {unit}, must be in {must}, as {other} has")


def _name(drive: Path, response: Path) -> str:
    return str(drive) if drive == response else f"{drive} + {response}"
