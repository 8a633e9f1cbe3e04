"""A drive and its response as they lie in files of other software: opened together, read block by block."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from glob import glob
from pathlib import Path

import numpy as np

from ctlblocks.recording import RecordingError
from vibractl.config import RigConfig
from vibractl.foreign.signals import Kind, drives_of, responses_of
from vibractl.foreign.tracks import BLOCK, Track, has_all, open_track
from vibractl.learner import Timeline

SHOT = 3
"""Times a shot's length, up to which a file of drives holds one shot, that may be anywhere in a longer response."""
_DIGITS = re.compile(r"(\d+)")


@dataclass(frozen=True, eq=False)
class Recorded:
    """A drive and a response.

    Parameters
    ----------
    drive, response : Track
        The same, where one file holds both: drives, responses, monitors.
    wanted : array, shape (samples, drives), V, or None
        The drive of one shot, which was played once or more while the response was recorded; None where drive and
        response lie beside each other, sample by sample.
    widths : tuple of int
        How many drives, responses and monitors of the drives there are.
    begins : int or None, samples
        Where the reference begins in the drive's file, which has a length that says so.
    """

    drive: Track
    response: Track
    wanted: np.ndarray | None
    widths: tuple[int, int, int]
    begins: int | None

    @property
    def name(self) -> str:
        """Of the response's file."""
        return str(self.response.path)

    @property
    def is_beside(self) -> bool:
        """Whether sample n of one belongs to sample n of the other."""
        return self.wanted is None

    @property
    def has_drive(self) -> bool:
        """Whether the drive is recorded along with the response."""
        return self.is_beside or self.widths[2] > 0

    @property
    def frames(self) -> int:
        """Samples of the response."""
        return self.response.frames

    @property
    def heard(self) -> slice:
        """Columns of the responses in a block."""
        first = self.widths[0] if self.is_beside else 0
        return slice(first, first + self.widths[1])

    @property
    def played(self) -> slice:
        """Columns of the drives in a block, where they lie beside."""
        return slice(0, self.widths[0])

    @property
    def monitors(self) -> slice:
        """Columns of the monitors in a block; none where there are none."""
        return slice(self.heard.stop, self.heard.stop + self.widths[2])

    @property
    def full_scale(self) -> np.ndarray:
        """The largest size that each column of a block can have, (columns,), V and m/s^2."""
        if not self.is_beside or self.drive is self.response:
            return self.response.full_scale
        return np.concatenate((self.drive.full_scale, self.response.full_scale))

    def blocks(self, size: int = BLOCK) -> Iterator[np.ndarray]:
        """Read drives where they lie beside, responses and monitors: arrays (at most `size`, columns), V, m/s^2, V."""
        if not self.is_beside or self.drive is self.response:
            yield from self.response.blocks(size)
            return
        for pair in zip(self.drive.blocks(size), self.response.blocks(size), strict=True):
            yield np.concatenate(pair, axis=1)


@dataclass(frozen=True)
class Scales:
    """What the number 1 of a sound is.

    Parameters
    ----------
    volts : float, V, of a drive
    acceleration : float, m/s^2, of a response
    """

    volts: float
    acceleration: float


def paired(drives: str, responses: str) -> list[tuple[Path, Path]]:
    """Return pairs of files by name or pattern, such as "shots/d*.wav", in natural order.

    Parameters
    ----------
    drives, responses : str

    Raises
    ------
    ValueError : a pattern that fits no file, or unequal numbers of files.
    """
    found = [_files(text) for text in (drives, responses)]
    if len(found[0]) != len(found[1]):
        raise ValueError(
            f"--drive {drives} is {len(found[0])} files and --response {responses} {len(found[1])}, must be as many: "
            "one of each a shot"
        )
    return list(zip(*found, strict=True))


def open_recorded(
    drive: Path, response: Path, rig: RigConfig, shot: Timeline, scales: Scales, given: Mapping[str, str]
) -> Recorded:
    """Open a drive and a response.

    Parameters
    ----------
    drive, response : Path
        May be one file that holds both.
    rig : RigConfig
    shot : Timeline
    scales : Scales
    given : mapping of str to str
        Channels, as of `parsed_map`.

    Raises
    ------
    RecordingError : a file that cannot be read, or lengths, rates or channels that do not fit.
    """
    audio = rig.audio
    kinds = [
        Kind("drive", drives_of(audio).width, "V", scales.volts),
        Kind("response", responses_of(audio).width, "m/s^2", scales.acceleration),
    ]
    monitor = Kind("monitor", kinds[0].width, "V", scales.volts)
    widths = kinds[0].width, kinds[1].width, 0
    if drive.resolve() == response.resolve():
        track = open_track(response, kinds, audio.rate, given)
        return Recorded(track, track, None, widths, _begins(track, shot))
    played = open_track(drive, kinds[:1], audio.rate, given)
    is_one = played.frames <= SHOT * shot.total
    watched = [monitor] if is_one and has_all(response, monitor, given, audio.rate) else []
    heard = open_track(response, [kinds[1], *watched], audio.rate, given)
    if played.frames == heard.frames and not watched:
        return Recorded(played, heard, None, widths, _begins(played, shot))
    widths = *widths[:2], monitor.width * len(watched)
    if heard.frames < played.frames or not is_one:
        most = ", or more where the drive is one shot's" if is_one else ""
        raise RecordingError(
            f"{response}: {heard.frames} samples, must be {played.frames}{most}: {drive} has as many, sample by sample "
            "beside it"
        )
    if played.frames < shot.sounded:
        raise RecordingError(f"{drive}: {played.frames} samples, must be at least {shot.sounded}, the reference's")
    wanted = np.concatenate(list(played.blocks()))
    return Recorded(played, heard, wanted, widths, _begins(played, shot))


def _begins(track: Track, shot: Timeline) -> int | None:
    """Return where the reference begins in a drive that is as long as a shot, or as the reference."""
    return {shot.total: shot.lead, shot.frames: 0, shot.sounded: 0}.get(track.frames)


def _files(text: str) -> list[Path]:
    if Path(text).exists() or not any(mark in text for mark in "*?["):
        return [Path(text)]
    found = sorted(glob(text), key=_natural)
    if not found:
        raise ValueError(f"{text}: no file is called so")
    return [Path(each) for each in found]


def _natural(name: str) -> tuple[tuple[int, int, str], ...]:
    """Return a key by which 2 comes before 10."""
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part) for part in _DIGITS.split(name))
