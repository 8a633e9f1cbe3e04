"""A rig that a file describes: what of it is in force, how it was edited since, and how it is read again."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import ClassVar, Generic, TypeVar

from ctlblocks.room import free
from rigkit.config_text import dump_values
from rigkit.disk_space import RESERVE
from rigkit.service.reload import Change, Reach, Served, edits, reloaded
from rigkit.service.show import Gauge

File = TypeVar("File", bound=Served)


class FiledRig(Generic[File]):
    """Reads its file, and again on a reload.

    Parameters
    ----------
    load : callable() -> File
        Reads the file, with the settings laid over it; again at each reload.

    Raises
    ------
    ValueError : the file cannot be used.
    """

    reaches: ClassVar[Mapping[str, Reach]] = {}
    """How deep an edit of each key goes, as of `reload.change`."""

    def __init__(self, load: Callable[[], File]) -> None:
        self._load, self.config = load, load()
        self._read = self.config

    def settings(self) -> str:
        """Return the settings in force, as TOML."""
        return dump_values(self.config.model_dump())

    def edits(self) -> str:
        """Say how the file was edited since it was read."""
        return edits(self._read, self.config, self._load)

    def reload(self) -> Change:
        """Read the file again, and take what can be taken; ValueError where it cannot be used."""
        new = self._load()
        self._check(new)
        return reloaded(self.config, new, self.reaches, lambda change: self._take(new, change))

    def room(self) -> Gauge:
        """Return the room on the disk that is recorded to."""
        there = free(Path(self.config.daemon.data).absolute())
        return Gauge("disk_free", "Room on the disk", there, "byte", low=RESERVE)

    def _check(self, new: File) -> None:
        """Refuse a file that cannot be taken, by ValueError."""

    def _take(self, new: File, change: Change) -> str:
        """Put a file in force; say from when on what it changes holds, if it changes anything."""
        self.config = self._read = new
        return "from the next procedure on" if change.keys else ""
