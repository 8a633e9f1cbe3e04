"""Replay: what robot, tracker and stage said goes through the controllers again; all must come out as it was."""

from collections.abc import Iterator
from pathlib import Path

from rigkit.experiment.replayed import Replayed, compared
from stagectl.machining.recorded import MADE
from stagectl.machining.run import Conduct, mill
from stagectl.machining.session import read_back
from stagectl.machining.surroundings import recorded


def replay_cell(path: Path) -> Iterator[Replayed]:
    """Make every output of a folder's runs again from their recorded sensors.

    Parameters
    ----------
    path : Path
        Run folder.

    Raises
    ------
    ValueError : it is none, nothing is recorded, or the run was stopped by its user.
    """
    for setup, (made, records, reason) in read_back(path).items():
        outputs = {name: signals for name, signals in MADE.items() if name in records}
        again = mill(made, Conduct(), recorded(records), outputs, {})
        if again.reason != reason:
            raise ValueError(f"setup {setup} was held because {reason!r}, and is now because {again.reason!r}")
        for name, kept in again.recordings.items():
            yield from compared(f"{setup}-{name}", records[name], kept)
