"""The folder of a run: what the run was given, did and found, whole at any moment and resumable."""

import csv
import os
import shutil
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Self

from rigkit import atomic, line_file
from rigkit.growing_wav import finish, unfinished
from rigkit.json_file import json_value
from rigkit.json_text import json_text
from rigkit.lock import FolderInUseError, Lock, holder
from rigkit.origin import has_more

CONFIG = "config.toml"
EVENTS = "events.jsonl"
QUALITY = "qc.csv"
SHOTS = "shots"
SUMMARY = "summary.json"
LOCK = ".lock"
REPORT = "`report` shows it"


class RunFolder:
    """The folder of one run, locked against other processes from `create` or `open` until `close`.

    It holds `config.toml` (as run), `shots/0000.wav` ..., `qc.csv` (a row per shot), `events.jsonl`, `summary.json`
    and what the rig writes beside them.  A kill at any moment leaves files that are whole, or not there: `open`
    sweeps up the rest.  A context manager; leaving it releases the lock, and leaving it by an exception takes a folder
    that was made, and has nothing in it but what the run was given, away again.
    """

    def __init__(self, path: Path, lock: Lock, made: Sequence[Path] = ()) -> None:
        self.path = path
        self.listener: Callable[[str, Mapping[str, Any]], None] = lambda event, fields: None  # noqa: ARG005
        """Told of each event once it is in the file."""
        self._lock, self._made = lock, made
        self._given: set[Path] | None = None
        self._telling = threading.Lock()

    @classmethod
    def create(cls, path: str | Path, config: str, way_on: str = REPORT) -> Self:
        """Make the folder of a new run.

        Parameters
        ----------
        path : str or Path
            Absent, or an empty folder.
        config : str
            The text of `config.toml`.
        way_on : str
            What to do with a run that is there.

        Raises
        ------
        FolderInUseError : something is there already; nothing is written.
        """
        path = Path(path)
        _refuse_used(path, way_on)
        made = atomic.absent(path)
        with atomic.folder(path):
            lock = Lock(path / LOCK)
            folder = cls(path, lock, made)
            try:
                _refuse_used(path)  # since another process may have been quicker
                folder._sweep()
                folder.write(CONFIG, config)
            except FolderInUseError:
                folder.close()
                raise
            except BaseException:
                folder.withdraw()
                raise
        folder.note_given()
        return folder

    @classmethod
    @contextmanager
    def filled(cls, path: str | Path, config: str, way_on: str = REPORT) -> Iterator[Self]:
        """Make the folder of a new run, as `create` does, and give it to be filled; where that fails it is taken away.

        What the block puts in it, such as models, is there when the run can be taken up.  The lock stays.
        """
        folder = cls.create(path, config, way_on)
        try:
            yield folder
        except BaseException:
            folder.withdraw()
            raise
        folder.note_given()

    @classmethod
    @contextmanager
    def built(cls, path: str | Path, config: str) -> Iterator[Self]:
        """Make the folder of a run that is whole as soon as it is there: it has another name until the block ends.

        Where the block fails nothing is left; what a kill left is swept away when the same folder is made again.

        Parameters
        ----------
        path : str or Path
            Absent, or an empty folder.
        config : str
            The text of `config.toml`.

        Raises
        ------
        FolderInUseError : something is there already; nothing is written.
        """
        path = Path(path)
        _refuse_used(path)
        with atomic.folder(path.absolute().parent) as above:
            for left in above.iterdir():
                is_its = left.name.startswith(f".{path.stem}.") and atomic.is_leftover(left)
                if is_its and left.is_dir() and holder(left / LOCK) is None:
                    shutil.rmtree(left)
            with cls.create(atomic.temporary(path), config) as folder:
                try:
                    yield folder
                    folder.move(path)
                except BaseException:
                    folder.withdraw()
                    raise

    def move(self, path: Path) -> None:
        """Take the place of an absent or empty folder, in one step."""
        if path.exists():
            _refuse_used(path)
            shutil.rmtree(path)
        atomic.to_disk(self.path)
        self.path.rename(path)
        self.path, self._made = path, [path]
        atomic.to_disk(path.absolute().parent)

    def note_given(self) -> None:
        """Take all that is in the folder now for what the run is given: nothing has come of it yet."""
        self._given = set(self._files())

    def take_in(self, source: Path, name: str) -> None:
        """Copy a file that the run is given into the folder, or into one below it, whole or not at all."""
        (self.path / name).parent.mkdir(parents=True, exist_ok=True)
        with self.replacing(name) as copy:
            shutil.copyfile(source, copy)
        if self._given is not None:
            self._given.add(self.path / name)

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Take up the folder of a run that was stopped or killed, and sweep up what a kill left.

        Raises
        ------
        ValueError : it is no run's folder.
        FolderInUseError : another process is working in it.
        """
        path = Path(path)
        if not (path / CONFIG).is_file():
            raise ValueError(f"{path}/ is not the folder of a run: it has no {CONFIG}")
        folder = cls(path, Lock(path / LOCK), [path])
        folder._sweep()
        return folder

    def withdraw(self) -> None:
        """Take the folder away with all that is in it: nothing has come of the run.  What was there stays, empty."""
        self.close()
        for entry in list(self.path.iterdir()) if self.path.exists() else ():
            shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
        atomic.remove_empty(self._made)

    def close(self) -> None:
        """Release the lock; may be called twice."""
        self._lock.release()

    def __enter__(self) -> Self:
        """Return the folder itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Release the lock; where nothing has come of a new run, take its folder away."""
        if kind is not None and self._given is not None and self._given.issuperset(self._files()):
            self.withdraw()
        self.close()

    def _files(self) -> Iterator[Path]:
        """Find the files that were put into the folder."""
        return (each for each in self.path.rglob("*") if each.is_file() and not _counts_as_empty(each))

    def shot(self, number: int) -> Path:
        """Return where the recording of a shot belongs, counted from 0; its folder is made with the first."""
        shots = self.path / SHOTS
        if not shots.is_dir():
            shots.mkdir()
            atomic.to_disk(self.path)
        return shots / f"{number:04d}.wav"

    def write(self, name: str, content: str | bytes) -> None:
        """Write a whole file in one step."""
        atomic.write(self.path / name, content)

    @contextmanager
    def replacing(self, name: str) -> Iterator[Path]:
        """Give a temporary name to write to, with the same suffix; the file takes its place when the block ends."""
        with atomic.replacing(self.path / name) as temporary:
            yield temporary

    def event(self, event: str, fields: Mapping[str, Any]) -> None:
        """Add a line to `events.jsonl`: the time (UTC), what happened, and its particulars.

        Raises
        ------
        ValueError : a field is called time or event.
        """
        if taken := fields.keys() & {"time", "event"}:
            raise ValueError(f"event {event}: a field is called {taken.pop()}, which the line has already")
        time = datetime.now(UTC).isoformat(timespec="milliseconds")
        with self._telling:
            line_file.append(self.path / EVENTS, json_text({"time": time, "event": event, **fields}))
        self.listener(event, fields)

    def quality(self, row: Mapping[str, Any]) -> None:
        """Add a row to `qc.csv`, under a header of its keys.

        Raises
        ------
        ValueError : the keys are not those of the rows before, or a cell holds a line break.
        """
        path = self.path / QUALITY
        written, header = line_file.first(path), line_file.as_csv(row.keys())
        if not written:
            line_file.append(path, header)
        elif written != header:
            raise ValueError(f"{path}: the columns are {written}, but the row has {header}")
        line_file.append(path, line_file.as_csv(row.values()))

    def summarise(self, figures: Mapping[str, Any]) -> None:
        """Write `summary.json`."""
        self.write(SUMMARY, f"{json_text(figures, indent=2)}\n")

    def _sweep(self) -> None:
        for path in list(atomic.leftovers(self.path)):
            path.unlink()
        for name in (EVENTS, QUALITY):
            line_file.repair(self.path / name)
        for growing in list(unfinished(self.path)):
            finish(growing)


def make_whole(path: Path) -> None:
    """Finish the recordings that were growing when a run was killed; ValueError while it is still at work."""
    if any(unfinished(path)):
        RunFolder.open(path).close()


def read_events(path: str | Path) -> list[dict[str, Any]]:
    """Read `events.jsonl` of the run folder `path`, without its lock; none where there is no such file.

    Raises
    ------
    ValueError : a line is no event.
    """
    file, events = Path(path) / EVENTS, []
    for number, line in enumerate(line_file.lines(file), start=1):
        event = json_value(line, f"{file}: line {number}", dict)
        if not {"time", "event"} <= event.keys():
            raise ValueError(f"{file}: line {number} is no event, it has no time or no name: {line[:60]!r}")
        events.append(event)
    return events


def read_quality(path: str | Path) -> list[dict[str, str]]:
    """Read the rows of `qc.csv` of the run folder `path`, without its lock; none where there is no such file."""
    return list(csv.DictReader(line_file.lines(Path(path) / QUALITY)))


def _refuse_used(path: Path, way_on: str = REPORT) -> None:
    if path.exists() and not path.is_dir():
        raise FolderInUseError(f"{path} is a file, must be a folder to make")
    held = sorted(entry.name for entry in path.iterdir() if not _counts_as_empty(entry)) if path.exists() else []
    if held and (process := holder(path / LOCK)) not in (None, os.getpid()):
        raise FolderInUseError(f"{path}/ is in use by process {process}; choose another folder")
    what, way = ", ".join([*held[:3], *["..."] * (len(held) > 3)]), ""
    if CONFIG in held:
        state, way = (
            ("", way_on) if has_more(path, (CONFIG, EVENTS)) else (" of which nothing is recorded", "delete it")
        )
        what, way = f"a run{state} ({what})", f"{way}, or "
    if held:
        raise FolderInUseError(f"{path}/ is in use: it holds {what}; {way}choose another folder")


def _counts_as_empty(entry: Path) -> bool:
    """Whether `create`, killed before the configuration was in its place, may have left this."""
    if entry.name == SHOTS and entry.is_dir():
        return not any(entry.iterdir())
    return entry.name == LOCK or atomic.is_leftover(entry)
