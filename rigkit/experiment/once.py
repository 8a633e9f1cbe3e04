"""Parts run into a folder one by one, for who needs each before it knows the next; none is run twice."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

from rigkit.experiment.kept import recordings, told, track_of
from rigkit.experiment.part import Part
from rigkit.experiment.resumed import ended_well, set_aside
from rigkit.experiment.runner import STOPPED, Conduct
from rigkit.experiment.succession import recorded
from rigkit.run_folder import RunFolder
from rigkit.stop import Stopped


class PartEnded(ValueError):
    """A part that a fault has ended; the text says which, and where its devices stand."""


@dataclass(frozen=True)
class Once:
    """Runs parts into a folder, each to its end once.

    Parameters
    ----------
    folder : RunFolder
    conduct : Conduct
    part_of : callable(str) -> str
        The name of the part that a track is of.
    """

    folder: RunFolder
    conduct: Conduct
    part_of: Callable[[str], str] = str

    def has(self, name: str) -> bool:
        """Whether a part of that name has come to its end: what is recorded of it, and told of no beginning, is whole.

        So it is in folders of versions that wrote a recording when it was whole.
        """
        path = self.folder.path
        if name not in {self.part_of(track_of(file)) for file in recordings(path)}:
            return False
        return name in ended_well(path) or name not in told(path, "started")

    def run(self, name: str, made: AbstractContextManager[Part]) -> None:
        """Run a part that the folder has not, recorded as it goes; what is there of it goes into a folder below.

        Parameters
        ----------
        name : str
        made : context manager of Part
            Entered once it may begin: opens its devices, and closes them.

        Raises
        ------
        Stopped, PartEnded : a person, or a fault, ended it; what was recorded until then is kept.
        Whatever `made` raises before it begins.
        """
        path, conduct = self.folder.path, self.conduct
        others = {self.part_of(track_of(file)) for file in recordings(path)} - {name}
        set_aside(path, others, self.part_of)
        conduct.between(name)
        if conduct.stopped():
            raise Stopped(f"{name}: stopped before it began")
        with made as part:
            reason = recorded(self.folder, part, {}, conduct)
        if reason:
            text = f"{name}: {reason}; what is recorded is in {path}/"
            raise Stopped(text) if reason == STOPPED else PartEnded(text)
