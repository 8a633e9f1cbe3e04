"""The folder of a library: entries by name, and which of them is nearest."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from rigkit import atomic
from rigkit.agreement import DisagreementError, agreed, measured_otherwise
from vibractl.config import RigConfig
from vibractl.library.entry import Entry, EntryError, read_entry, write_entry
from vibractl.library.fit import misfit
from vibractl.library.tags import distances
from vibractl.reference import Reference

SUFFIX = ".h5"
_NAME = re.compile(r"[A-Za-z0-9][\w.-]{0,79}", re.ASCII)


def user_library() -> Path:
    """Return where this user's library is kept."""
    return Path(platformdirs.user_data_dir("vibrostage")) / "library"


@dataclass(frozen=True)
class Candidate:
    """An entry that fits a run.

    Parameters
    ----------
    name : str
    entry : Entry
    distance : float, 1
        Of its tags from those asked for.
    """

    name: str
    entry: Entry
    distance: float


class Library:
    """Entries as files `NAME.h5` in one folder, which is made when the first is added.

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path: Path) -> None:
        if path.exists() and not path.is_dir():
            raise EntryError(f"library {path} is a file, must be a folder")
        self.path = path

    @property
    def names(self) -> list[str]:
        """The names of all entries, in order."""
        files = self.path.glob(f"*{SUFFIX}") if self.path.is_dir() else ()
        return sorted(file.stem for file in files if _NAME.fullmatch(file.stem))

    def file(self, name: str) -> Path:
        """Return where an entry is kept.

        Raises
        ------
        EntryError : not a name.
        """
        if not _NAME.fullmatch(name):
            raise EntryError(f"name {name!r} must be 1 to 80 letters, digits or . _ -, a letter or digit first")
        return self.path / f"{name}{SUFFIX}"

    def read(self, name: str) -> Entry:
        """Read an entry.

        Raises
        ------
        EntryError : not a name, no such entry, or a damaged one.
        """
        file = self.file(name)
        if not file.is_file():
            there = ", ".join(self.names[:10]) or "nothing"
            raise EntryError(f"library {self.path} has no entry {name!r}; it holds {there}")
        return read_entry(file)

    def write(self, name: str, entry: Entry, replace: bool) -> Path:
        """Keep an entry, and return its file.

        Parameters
        ----------
        name : str
        entry : Entry
        replace : bool
            Whether one of that name gives way.

        Raises
        ------
        EntryError : not a name, or there is one and it does not give way; nothing is written.
        """
        file = self.file(name)
        if file.exists() and not replace:
            raise EntryError(f"library {self.path} has an entry {name!r} already; --force replaces it")
        with atomic.folder(self.path):
            write_entry(file, entry.named(name))
        return file

    def remove(self, name: str) -> None:
        """Take an entry away, damaged or not."""
        file = self.file(name)
        if not file.is_file():
            self.read(name)  # says what there is
        file.unlink()

    def ranked(
        self, config: RigConfig, reference: Reference, asked: Mapping[str, str], accept: Collection[str] = ()
    ) -> tuple[list[Candidate], dict[str, str]]:
        """Return the entries that fit a run, the nearest first, and of each other one why it does not.

        Of entries equally near the latest comes first.

        Parameters
        ----------
        config : RigConfig
        reference : Reference
        asked : mapping of str
            Tags.
        accept : collection of str
            Keys in which the rig that an entry was learned on may differ.
        """
        fitting: dict[str, Entry] = {}
        refused: dict[str, str] = {}
        for name in self.names:
            try:
                entry = self.read(name)
            except EntryError as fault:
                refused[name] = str(fault)
                continue
            if reason := misfit(entry, config, reference) or _wired_otherwise(entry, config, accept):
                refused[name] = reason
            else:
                fitting[name] = entry
        apart = distances(asked, [entry.tags for entry in fitting.values()])
        found = [Candidate(name, entry, far) for (name, entry), far in zip(fitting.items(), apart, strict=True)]
        found.sort(key=lambda each: each.entry.about["date"], reverse=True)
        return sorted(found, key=lambda each: each.distance), refused

    def nearest(
        self, config: RigConfig, reference: Reference, asked: Mapping[str, str], accept: Collection[str] = ()
    ) -> Candidate:
        """Return the entry nearest to a run.

        Raises
        ------
        EntryError : none fits.
        """
        found, refused = self.ranked(config, reference, asked, accept)
        if not found:
            reasons = "; ".join(f"{name}: {reason}" for name, reason in list(refused.items())[:3])
            raise EntryError(f"library {self.path} has no entry that fits: {reasons or 'it is empty'}")
        return found[0]

    def fitting(self, name: str, config: RigConfig, reference: Reference, accept: Collection[str] = ()) -> Entry:
        """Return the entry of that name.

        Raises
        ------
        EntryError : there is none, or it does not fit the run.
        """
        entry = self.read(name)
        if reason := misfit(entry, config, reference) or _wired_otherwise(entry, config, accept):
            raise EntryError(f"library entry {name} is {reason}")
        return entry


def _wired_otherwise(entry: Entry, config: RigConfig, accept: Collection[str]) -> str:
    """Say how the rig that an entry was learned on was wired otherwise; nothing where that does no harm."""
    found = measured_otherwise("vibrator", entry.about, config, f"library entry {entry.name}")
    try:
        agreed(found, accept, "of a rig that was wired otherwise", "learn it again")
    except DisagreementError as fault:
        return str(fault)
    return ""
