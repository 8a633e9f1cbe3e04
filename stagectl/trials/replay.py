"""Replay: what robot and tracker said goes through a trial's graph again; all must come out as it was."""

from collections.abc import Iterator
from pathlib import Path

from stagectl.machining.run import Conduct
from stagectl.replay import Replayed, compared
from stagectl.trials.recorded import MADE
from stagectl.trials.run import run
from stagectl.trials.session import read_back
from stagectl.trials.surroundings import recorded


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
        again = run(done.trial, Conduct(), recorded(done.records), MADE, {})
        for name, kept in again.recordings.items():
            yield from compared(f"{done.name}-{name}", done.records[name], kept)
