"""Replay: the recorded responses go through the run's own graph again, and every drive must come out as it was."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from vibractl.guard import Guard
from vibractl.learner import Learner
from vibractl.quality import FAINT, decibels
from vibractl.run_setup import is_imported, shot_files
from vibractl.setup import Setup
from vibractl.shot_file import channel_names, far_field_of, split
from vibractl.trial import shot_graph


@dataclass(frozen=True)
class Replayed:
    """One shot's drive, recorded and rebuilt.

    Parameters
    ----------
    shot : int
    drive : float32 array, shape (samples, drives), V, rebuilt
    recorded : float32 array, shape (samples, drives), V
    """

    shot: int
    drive: np.ndarray
    recorded: np.ndarray

    @property
    def identical(self) -> bool:
        """Whether every sample is the same, bit for bit."""
        return self.drive.tobytes() == self.recorded.tobytes()

    @property
    def difference(self) -> float:
        """Largest difference, V."""
        return float(np.abs(self.drive - self.recorded).max())

    @property
    def difference_db(self) -> float:
        """RMS difference re the recorded drive's RMS, dB."""
        size = max(float(np.linalg.norm(self.recorded)), FAINT)
        return float(decibels(float(np.linalg.norm(self.drive - self.recorded)) / size))


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
    for shot, file in enumerate(files):
        record = recording.read(file, rate=made.shot.rate)
        if len(record.data) != made.shot.total:
            raise ValueError(f"{file}: {len(record.data)} samples, must be {made.shot.total}")
        recorded, _ = split(record, made.config)
        yield Replayed(shot, _through_graph(learner, record, made), np.asarray(recorded, dtype=np.float32))
        if is_foreign:
            learner.played(recorded)
        if learner.far_field.shape[1]:
            learner.far_field[:] = far_field_of(record, made.config)
        learner.advance()


def _through_graph(learner: Learner, record: Recording, made: Setup) -> np.ndarray:
    """Play one recording through the shot's graph and return what leaves the guard."""
    config = made.config
    source = Replay(record, {"response": channel_names(config)[1]})
    guard = Guard(config.limits, len(config.audio.drive_channels))
    frames = config.audio.blocksize
    graph = shot_graph(source, learner, guard, config.audio.rate, frames)
    graph.prepare()
    guard.open()
    ticks = -(-made.shot.total // frames)
    output = graph.signal("guard.output")
    drive = np.zeros((ticks * frames, output.shape[1]), np.float32)
    for tick in range(ticks):
        graph.tick()
        drive[tick * frames : (tick + 1) * frames] = output
    return drive[: made.shot.total]
