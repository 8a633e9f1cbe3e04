"""Replay: what robot and tracker said goes through a trial's graph again; all must come out as it was."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from rigkit.experiment.replayed import Replayed, compared
from stagectl.trials.conduct import Conduct
from stagectl.trials.done import DoneTrial
from stagectl.trials.recorded import MADE, SLOW
from stagectl.trials.run import run
from stagectl.trials.session import read_back
from stagectl.trials.surroundings import recorded


class _User:
    """Stops a trial where its tool began to retreat; where a fault did that, nothing is left to stop."""

    def __init__(self, done: DoneTrial) -> None:
        retreating = np.flatnonzero(done.records["trial"].select(["retreating"]).data[:, 0])
        self._stops = SLOW * int(retreating[0]) if len(retreating) else done.trial.path.samples * SLOW + 1
        self._ticks = 0

    def look(self, ticks: int) -> None:
        self._ticks = ticks

    def stopped(self) -> bool:
        return self._ticks >= self._stops


def replay_trials(path: Path) -> Iterator[Replayed]:
    """Make every output of a folder's trials again from their recorded sensors.

    Parameters
    ----------
    path : Path
        Run folder.

    Raises
    ------
    ValueError : it is none, or nothing is recorded.
    """
    for done in read_back(path):
        user = _User(done)
        again = run(done.trial, Conduct(stopped=user.stopped, show=user.look), recorded(done.records), MADE, {})
        for name, kept in again.recordings.items():
            yield from compared(f"{done.name}-{name}", done.records[name], kept)
