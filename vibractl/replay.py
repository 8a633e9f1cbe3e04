"""Replay: the recorded responses go through the run's own graph again, and every drive must come out as it was."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks.graph import Graph
from rigkit.foreign_record import open_signals
from rigkit.foreign_stream import Signals
from vibractl.decibels import FAINT, decibels
from vibractl.guard import Guard
from vibractl.learner import Learner
from vibractl.run_setup import is_imported, shot_files
from vibractl.setup import Setup
from vibractl.shot_file import channel_names, hydrophone_names
from vibractl.trial import FrameInput, shot_graph

TICKS = 64
"""Between two looks at a file."""


@dataclass
class Replayed:
    """One shot's drive, rebuilt and compared with the recorded one.

    Parameters
    ----------
    shot : int
    seconds : float, s
        How long the shot is.
    identical : bool
        Whether every sample is the same, bit for bit.
    difference : float, V
        The largest.
    """

    shot: int
    seconds: float
    identical: bool = True
    difference: float = 0.0
    _size: float = 0.0
    _off: float = 0.0

    @property
    def difference_db(self) -> float:
        """RMS difference re the recorded drive's RMS, dB."""
        return float(decibels(float(np.sqrt(self._off)) / max(float(np.sqrt(self._size)), FAINT)))

    def compare(self, drive: np.ndarray, recorded: np.ndarray) -> None:
        """Take what comes next of both, rebuilt and recorded, float32 arrays of shape (samples, drives), V."""
        self.identical &= drive.tobytes() == recorded.tobytes()
        off = drive.astype(float) - recorded
        self.difference = max(self.difference, float(np.abs(off).max()))
        self._size += float(np.sum(recorded.astype(float) ** 2))
        self._off += float(np.sum(off**2))


def replay(path: Path, made: Setup) -> Iterator[Replayed]:
    """Rebuild the drives of a run from its recorded responses, in order.

    Of a run that other software has played each drive is the one that the law makes of what was played before.

    Parameters
    ----------
    path : Path
        Run folder.
    made : Setup
        `session.setup_of(path)` for what was done; of other settings or another model for what would have been done.

    Raises
    ------
    ValueError : nothing is recorded, or a recording is not of this run's length and channels.
    """
    files = shot_files(path)
    if not files:
        raise ValueError(f"{path}: no shot is recorded")
    learner, is_foreign = made.learner(), is_imported(path)
    drives = len(made.config.audio.drive_channels)
    for shot, file in enumerate(files):
        record = _opened(file, made)
        yield _through_graph(Replayed(shot, made.shot.total / made.shot.rate), learner, record, made)
        if is_foreign:
            learner.played(record.select(record.names[:drives]).whole().data)
        learner.advance()


def _opened(file: Path, made: Setup) -> Signals:
    """Open one recording: its drives, responses and hydrophones; ValueError where it is not of this run."""
    record = open_signals(file)
    if record.rate != made.shot.rate:
        raise ValueError(f"{file}: {record.rate:.15g} samples/s, must be {made.shot.rate:.15g}")
    if record.frames != made.shot.total:
        raise ValueError(f"{file}: {record.frames} samples, must be {made.shot.total}")
    drives, responses = channel_names(made.config)
    return record.select([*drives, *responses, *hydrophone_names(made.config)])


def _through_graph(replayed: Replayed, learner: Learner, record: Signals, made: Setup) -> Replayed:
    """Play one recording through the shot's graph, block by block, and compare what leaves the guard with it."""
    audio = made.config.audio
    drives, responses = len(audio.drive_channels), len(audio.response_channels)
    source, guard, frames = FrameInput(responses), Guard(made.config.limits, drives), audio.blocksize
    graph = shot_graph(source, learner, guard, audio.rate, frames)
    graph.prepare()
    guard.open()
    done = 0
    for block in record.blocks(TICKS * frames):
        recorded, response, far_field = np.split(block, [drives, drives + responses], axis=1)
        replayed.compare(_emitted(graph, source, response), recorded.astype(np.float32))
        if learner.far_field.shape[1]:
            learner.far_field[done : done + len(block)] = far_field
        done += len(block)
    return replayed


def _emitted(graph: Graph, source: FrameInput, response: np.ndarray) -> np.ndarray:
    """Tick the graph while this response comes in; return what leaves the guard, float32, (samples, drives), V."""
    output, frames = graph.signal("guard.output"), len(source.frame)
    drive = np.zeros((len(response), output.shape[1]), np.float32)
    for first in range(0, len(response), frames):
        part = response[first : first + frames]
        source.frame[: len(part)] = part
        source.frame[len(part) :] = 0.0
        graph.tick()
        drive[first : first + frames] = output[: len(part)]
    return drive
