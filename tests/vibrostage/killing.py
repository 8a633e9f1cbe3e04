"""Kills worker processes of a study at random, again and again, while it is run."""

import os
import random
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Thread


def workers(of: int) -> list[int]:
    """Return the processes that are workers of a study, of all that a process has started."""
    return [pid for pid in children(of) if b"rigkit.study.worker" in _command(pid)]


def children(of: int) -> list[int]:
    """Return all processes that a process has started, and those that they have."""
    found = []
    for task in Path(f"/proc/{of}/task").glob("*"):
        with suppress(OSError):
            found += [int(pid) for pid in (task / "children").read_text().split()]
    return found + [pid for child in found for pid in children(child)]


@contextmanager
def killed_after(tasks: int, place: Path, of: int) -> Iterator[list[int]]:
    """Kill one worker of a process each time that so many tasks have begun; gives the list of those that were.

    Parameters
    ----------
    tasks : int
    place : Path
        Tasks have their folders in it, or below.
    of : int
        Process.
    """
    seen, killed = set[str](), list[int]()

    def is_due() -> bool:
        seen.update(_tasks(place))
        return len(seen) > tasks * (len(killed) + 1)

    with _killing(0.01, is_due, of, killed):
        yield killed


@contextmanager
def killed_every(seconds: float, of: int) -> Iterator[list[int]]:
    """Kill one worker of a process every so often; gives the list of those that were."""
    killed = list[int]()
    with _killing(seconds, lambda: True, of, killed):
        yield killed


@contextmanager
def _killing(seconds: float, is_due: Callable[[], bool], of: int, killed: list[int]) -> Iterator[None]:
    """Look every so often whether a kill is due, and kill one of the workers."""
    chance, over = random.Random(4), Event()

    def kill() -> None:
        while not over.wait(seconds):
            if is_due() and (there := workers(of)):
                killed.append(chance.choice(there))
                with suppress(ProcessLookupError):
                    os.kill(killed[-1], signal.SIGKILL)

    thread = Thread(target=kill)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def _tasks(place: Path) -> list[str]:
    try:
        return [each.name for each in place.rglob("*-*") if each.is_dir()]
    except OSError:  # one that goes while it is looked at
        return []


def _command(pid: int) -> bytes:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""
