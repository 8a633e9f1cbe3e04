"""Joints taken out of what was recorded of clamping procedures: a recording a joint, and the way to the clamp."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit.disk_space import require
from rigkit.experiment.kept import recordings, records_of, track_of
from stagectl.wire.robot import RATE

SEEN = ("angle", "torque", "link", "pose", "frames")
"""Of the robot's outputs, where it has them: what a joint's recording is of."""
APPROACH = "approach"
"""The way to the clamp: from it the axes are found about which the tracked links turn."""
PROCEDURE = "clamping"
"""Begins the names of recordings of a procedure, which end in its number."""

A_JOINT = 600.0
"""s of a joint's record, as a rule at most: the search for its limits, and its cycles."""
CHANNELS = 96
"""Of it, at most, in the procedure's record and in its own."""


def recording_name(joint: int) -> str:
    """Return how the recording of a joint, from 0, is called."""
    return f"joint-{joint + 1}.wav"


def next_procedure(folder: Path) -> str:
    """Return the name of the next procedure that is recorded in a folder."""
    there = {track_of(file) for file in recordings(folder)}
    return f"{PROCEDURE}-{1 + sum(name.startswith(f'{PROCEDURE}-') for name in there)}"


def missing(folder: Path, joints: Sequence[int]) -> tuple[int, ...]:
    """Return the joints, from 0, that have no recording in a folder yet."""
    return tuple(joint for joint in joints if not (folder / recording_name(joint)).exists())


def require_room(folder: Path, joints: int) -> None:
    """Refuse, by a `DiskFault`, to begin on so many joints where the disk has no room for them.

    Parameters
    ----------
    folder : Path
    joints : int
    """
    needed = joints * bytes_of(round(A_JOINT * RATE), CHANNELS, "float64", "wav")
    require(folder, needed, f"{joints} joints")


def take_out(folder: Path) -> None:
    """Write a recording of each joint that a procedure has come to the end of, where there is none yet.

    Parameters
    ----------
    folder : Path
        With the records of procedures that have ended, or were killed.
    """
    for name, record in records_of(folder, f"{PROCEDURE}-").items():
        new = {joint: rows for joint, rows in _stretches(record).items() if missing(folder, [joint])}
        for joint, rows in new.items():
            recording.write(folder / recording_name(joint), _part(record, rows, name))
        soft = np.flatnonzero(record.select(["soft"]).data[:, 0])
        if new and len(soft):
            recording.write(folder / f"{APPROACH}.wav", _part(record, slice(0, int(soft[0])), name))


def read(folder: Path, joints: Sequence[int]) -> tuple[dict[int, Recording], Recording | None]:
    """Return the recordings of joints, from 0, and of the way to the clamp, where there is one.

    Parameters
    ----------
    folder : Path
    joints : sequence of int
    """
    way = folder / f"{APPROACH}.wav"
    found = {joint: recording.read(folder / recording_name(joint)) for joint in joints}
    return found, recording.read(way) if way.exists() else None


def _stretches(record: Recording) -> dict[int, slice]:
    """Return the rows of each joint, from 0, that was moved until the procedure went on: to another, or unclamped.

    One that was aborted moves none any more, and leaves the clamp closed.
    """
    moved, clamp = record.select(["joint", "clamp"]).data.T.astype(int)
    edges = np.flatnonzero(np.diff(moved)) + 1
    starts = [0, *edges.tolist()]
    return {
        int(moved[start]) - 1: slice(start, end)
        for start, end in zip(starts, edges.tolist(), strict=False)
        if moved[start] > 0 and (moved[end:].any() or not clamp[end:].all())
    }


def _part(record: Recording, rows: slice, source: str) -> Recording:
    names = [name for name in record.names if name.rpartition("_")[0] in SEEN]
    made = record.select(names)
    return replace(made, data=made.data[rows].astype(np.float32), provenance={**made.provenance, "procedure": source})
