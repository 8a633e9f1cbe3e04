"""Kills worker processes of a study at random, again and again, while it is run."""

import os
import random
import signal
from collections.abc import Iterator
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
    chance, over, killed, seen = random.Random(4), Event(), list[int](), set[str]()

    def kill() -> None:
        while not over.wait(0.01):
            seen.update(_tasks(place))
            if len(seen) > tasks * (len(killed) + 1) and (there := workers(of)):
                killed.append(chance.choice(there))
                with suppress(ProcessLookupError):
                    os.kill(killed[-1], signal.SIGKILL)

    thread = Thread(target=kill)
    thread.start()
    try:
        yield killed
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
