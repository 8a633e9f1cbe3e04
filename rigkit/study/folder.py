"""The folder of a study: what it began with, its files and its results; one program at a time works in it."""

import shutil
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from typing import Self

from rigkit import atomic
from rigkit.agreement import GOING_ON, Difference, accepted, agreed, changed_parts, differences
from rigkit.config import dump
from rigkit.lock import Lock
from rigkit.origin import RUN, Origin, read_origin
from rigkit.provenance import software
from rigkit.run_folder import CONFIG, LOCK
from rigkit.study import results
from rigkit.study.plan import Plan
from rigkit.study.results import About, Row

FILES, TASKS = "files", "tasks"
KIND = "study"
SOFTWARE = "software"
_WAY_OUT = "give another --out"


class StudyFolder:
    """The folder of one study, locked until it is left.

    It holds `run.json` and `config.toml` (as run), `files/` that every task finds in its folder, `results/*.parquet`
    and, while it is at work, a folder of each task in `tasks/`.

    Parameters
    ----------
    path : Path
        Absent, an empty folder, or that of the same study.
    plan : Plan
    accept : collection of str
        Keys that may differ from those which the study began with.

    Raises
    ------
    ValueError : another study's folder, or something else is in it.
    """

    def __init__(self, path: Path, plan: Plan, accept: Collection[str] = ()) -> None:
        self.path, self.plan = path, plan
        self.notes: list[str] = []
        """What has changed, without harm, since the study began."""
        self._made = atomic.absent(path)
        with atomic.folder(path):
            self._lock = Lock(path / LOCK)
            try:
                self._take_up(accept)
            except BaseException:
                self._lock.release()
                if not (path / RUN).exists():
                    (path / LOCK).unlink(missing_ok=True)
                raise

    @property
    def results(self) -> Path:
        """Where batches of rows are."""
        return self.path / results.FOLDER

    @property
    def files(self) -> Path:
        """What every task finds in its folder."""
        return self.path / FILES

    @property
    def tasks(self) -> Path:
        """Where tasks have their folders."""
        return self.path / TASKS

    @property
    def about(self) -> About:
        """What the rows are of."""
        study = self.plan.study
        return About(study.name, study.purpose, self.plan.figures, self.plan.sums, study.group)

    def rows(self) -> list[Row]:
        """Return what has come of the study so far."""
        return results.read_rows(self.results)[1] if any(self.results.glob("*.parquet")) else []

    def write(self, rows: list[Row]) -> None:
        """Write a batch, whole or not at all."""
        results.write_rows(results.next_file(self.results), rows, self.about)

    def finish(self) -> None:
        """Make one file of all results, and take away what tasks have left."""
        results.compact(self.results, self.about)
        if self.tasks.exists() and not any(self.tasks.iterdir()):
            self.tasks.rmdir()

    def __enter__(self) -> Self:
        """Return the folder itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Release the lock."""
        self._lock.release()

    def _take_up(self, accept: Collection[str]) -> None:
        there = read_origin(self.path / RUN)
        if there is None:
            self._begin(accept)
        else:
            self._go_on(there, accept)
        for folder in (self.results, self.tasks):
            folder.mkdir(exist_ok=True)
        for left in list(atomic.leftovers(self.path)):
            left.unlink()

    def _begin(self, accept: Collection[str]) -> None:
        held = [each.name for each in self.path.iterdir() if each.name not in (LOCK, FILES, CONFIG)]
        if held:
            raise ValueError(f"{self.path}/ is in use: it holds {held[0]}; choose another folder")
        shutil.rmtree(self.files, ignore_errors=True)
        self.files.mkdir()
        for name, file in self.plan.files.items():
            shutil.copyfile(file, self.files / name)
        origin = Origin.of(KIND, self.plan.study, {name: self.files / name for name in self.plan.files})
        atomic.write(self.path / CONFIG, dump(self.plan.study))
        origin.accepting(accept).write(self.path / RUN)

    def _go_on(self, there: Origin, accept: Collection[str]) -> None:
        if there.kind != KIND:
            raise ValueError(f"{self.path}/ is of a {there.kind}, must be of a study; choose another folder")
        now = Origin(KIND, self.plan.study.model_dump(mode="json"), {}, software())
        found = [*differences(there.settings, self.plan.study, GOING_ON), *changed_parts(there, self.plan.sums)]
        if there.software != now.software:
            found.append(Difference(SOFTWARE, there.software, now.software, True))
        self.notes = agreed(found, accept, f"{self.path}/ is of another study", _WAY_OUT)
        keys = accepted(found, accept)
        self.notes = [note.replace("is of another study", "has changed since it began") for note in self.notes]
        kept = replace(now, parts=there.parts, measured=there.measured, accepted=there.accepted).accepting(keys)
        atomic.write(self.path / CONFIG, dump(self.plan.study))
        kept.write(self.path / RUN)
