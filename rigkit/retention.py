"""Old runs that are deleted to make room; never one that is at work, that is marked, or that is the newest."""

import shutil
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rigkit.lock import FolderInUseError, Lock
from rigkit.run_folder import CONFIG, LOCK

MARK = "keep"
"""A file of this name in a run's folder keeps it for ever."""
DAY = 86_400.0
"""s."""
AHEAD = 60.0
"""s by which the clock of a disk's own computer may be ahead."""
FIRST = 1_704_067_200.0
"""s since 1970, the beginning of 2024: this program and its runs are younger; a clock that begins anew shows less."""
_DELETED = ".deleted"


@dataclass(frozen=True)
class StoredRun:
    """A run on the disk.

    Parameters
    ----------
    path : Path
    size : int, bytes
    changed : float, s since 1970
        When its newest file was written.
    is_marked : bool
    is_misdated : bool
        Whether all of its files are from the future, or from before `FIRST`: the clock was wrong, nobody knows how old
        it is, and it is kept.
    """

    path: Path
    size: int
    changed: float
    is_marked: bool
    is_misdated: bool = False


@dataclass(frozen=True)
class Policy:
    """What is kept; None for no limit of that kind.

    Parameters
    ----------
    newest : int, runs
    size : float, bytes of all that is kept, from the newest on
    days : float, since a run's last change
    """

    newest: int | None = None
    size: float | None = None
    days: float | None = None


def stored_runs(root: Path) -> list[StoredRun]:
    """Return the runs whose folders lie in `root`, the newest first; other folders, files and links are none.

    Raises
    ------
    ValueError : there is no such folder.
    """
    if not root.is_dir():
        raise ValueError(f"{root}: there is no such folder")
    shown = (path for path in root.iterdir() if not path.name.startswith("."))
    folders = [path for path in shown if path.is_dir() and not path.is_symlink()]
    now = time.time() + AHEAD
    found = [_stored(path, now) for path in folders if (path / CONFIG).is_file() and (path / LOCK).is_file()]
    return sorted(found, key=lambda run: (run.changed, run.path), reverse=True)


def superfluous(runs: Sequence[StoredRun], policy: Policy, now: float) -> list[StoredRun]:
    """Return the runs that a policy does not keep, the newest first.

    Parameters
    ----------
    runs : sequence of StoredRun, the newest first
        The first is kept whatever the policy says; those that are marked count, and are kept.
    policy : Policy
    now : float, s since 1970
    """
    found, size = [], 0
    for number, run in enumerate(each for each in runs if not each.is_misdated):
        size += run.size
        is_beyond = (
            (policy.newest is not None and number >= policy.newest)
            or (policy.size is not None and size > policy.size)
            or (policy.days is not None and now - run.changed > policy.days * DAY)
        )
        if is_beyond and number > 0 and not run.is_marked:
            found.append(run)
    return found


def delete(run: StoredRun) -> bool:
    """Delete a run, or return False where a process works in it.

    A kill on the way leaves a hidden folder that is no run any more; `sweep` takes it away.
    """
    try:
        lock = Lock(run.path / LOCK)
    except FolderInUseError:
        return False
    try:
        hidden = run.path.with_name(f".{run.path.name}{_DELETED}")
        run.path.rename(hidden)
        shutil.rmtree(hidden)
    finally:
        lock.release()
    return True


def sweep(root: Path) -> None:
    """Take away what deletions that were killed have left."""
    for path in root.glob(f".*{_DELETED}"):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)


def prune(root: Path, policy: Policy) -> Iterator[tuple[StoredRun, bool]]:
    """Delete what a policy does not keep, and tell of each run whether it is gone; one at work is not.

    Parameters
    ----------
    root : Path
        The folder of runs.
    policy : Policy
    """
    sweep(root)
    for run in superfluous(stored_runs(root), policy, time.time()):
        yield run, delete(run)


def _stored(path: Path, now: float) -> StoredRun:
    """Describe a run; what is dated after `now`, or before `FIRST`, tells nothing of its age."""
    stats = [file.lstat() for file in path.rglob("*") if not file.is_dir() and file.name != LOCK]
    dates = [stat.st_mtime for stat in stats] or [path.stat().st_mtime]
    past = [date for date in dates if FIRST <= date <= now]
    size = sum(stat.st_size for stat in stats)
    return StoredRun(path, size, max(past, default=0.0), (path / MARK).exists(), not past)
