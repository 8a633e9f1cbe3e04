"""A run that was killed, or ended early, taken up for what is left of it."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from rigkit import atomic
from rigkit import config as rig_file
from rigkit.config import Section
from rigkit.disk_space import require
from rigkit.experiment.kept import recordings, told, track_of
from rigkit.experiment.kind import Experiment
from rigkit.run_folder import CONFIG, RunFolder
from rigkit.run_origin import going_on

Some = TypeVar("Some", bound=Experiment)


@dataclass(frozen=True)
class GoingOn(Generic[Some]):
    """How a run is gone on with.

    Parameters
    ----------
    settings : type of Section
        Of its rig file.
    make : callable(frozenset of str) -> Experiment
        Makes what is left, from the names of the parts that have come to their end.
    part_of : callable(str) -> str
        The name of the part that a track is of.
    accept : collection of str
        Keys of its rig file, or names of its parts, that may have changed since it began.
    say : callable(str)
        Told what has.
    """

    settings: type[Section]
    make: Callable[[frozenset[str]], Some]
    part_of: Callable[[str], str]
    accept: Collection[str] = ()
    say: Callable[[str], object] = lambda _: None


def take_up(path: Path, way: GoingOn[Some]) -> tuple[RunFolder, Some]:
    """Open the folder of a run that was killed, or ended early, for what is left of it.

    What was recorded of parts that have not come to their end goes into a folder below it, `before-1` and so on.

    Parameters
    ----------
    path : Path
        Of its folder.
    way : GoingOn

    Raises
    ------
    ValueError : it is no run's folder, or nothing is left.
    DisagreementError : something has changed since it began that would spoil it.
    FolderInUseError : another program works in it.
    DiskFault : there is no room for the recordings.
    """
    folder = RunFolder.open(path)
    try:
        for text in going_on(folder, rig_file.load(path / CONFIG, way.settings, as_written=True), way.accept):
            way.say(text)
        done = ended_well(path)
        experiment = way.make(done)
        require(path, experiment.room, "the recordings")
        aside = set_aside(path, done, way.part_of)
        folder.event("resumed", {"done": sorted(done), **({"before": aside.name} if aside else {})})
    except BaseException:
        folder.close()
        raise
    return folder, experiment


def ended_well(path: Path) -> frozenset[str]:
    """Return the names of the parts that have come to their end, from what is told in a run's folder."""
    return frozenset(part for part, end in told(path, "ended").items() if not end["reason"])


def set_aside(path: Path, done: Collection[str], part_of: Callable[[str], str]) -> Path | None:
    """Move recordings of other parts than those into a new folder below a run's; return that, or None.

    Parameters
    ----------
    path : Path
        Of the run's folder.
    done : collection of str
        Names of parts whose recordings stay.
    part_of : callable(str) -> str
        The name of the part that a track is of.
    """
    files = [file for file in recordings(path) if part_of(track_of(file)) not in done]
    if not files:
        return None
    number = 1 + sum(each.is_dir() and each.name.startswith("before-") for each in path.iterdir())
    aside = path / f"before-{number}"
    aside.mkdir()
    for file in files:
        file.rename(aside / file.name)
    atomic.to_disk(path)
    return aside
