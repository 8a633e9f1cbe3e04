"""A witness of the machine: how late each core wakes who waits, before all that the cell's two ends do there.

`python -m benchmarks.wires.witness CORE FILE` writes moments (s of the system's clock) and lateness (s), until it ends.
"""

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Event

import numpy as np

from stagectl.doctor.wake_up import wake_ups

PERIOD = 1e-3
"""s from one moment that is waited for to the next."""
PRIORITY = 60
"""Real-time; higher than that of the ends."""
_STRETCH = 5.0
"""s that are written at once."""
_LEAST = 5e-4
"""s: what is less late is not kept."""


def watch(core: int, file: Path) -> None:
    """Watch a core until SIGTERM."""
    os.sched_setaffinity(0, {core})
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    over = Event()
    signal.signal(signal.SIGTERM, lambda *_: over.set())
    with file.open("wb") as out:
        while not over.is_set():
            moments = list[float]()

            def now(kept: list[float] = moments) -> float:
                kept[:] = kept or [time.time()]
                return time.time()

            seen = wake_ups(PERIOD, _STRETCH, now=now)
            due = moments[0] + PERIOD * np.arange(1, len(seen.late) + 1)
            late = seen.late > _LEAST
            np.column_stack([due[late], seen.late[late]]).tofile(out)
            out.flush()


@contextlib.contextmanager
def witnesses(folder: Path) -> Iterator[list[Path]]:
    """Have each core watched for the length of the block; give the files that are written."""
    files = {core: folder / f"core-{core}.bin" for core in sorted(os.sched_getaffinity(0))}
    command = [sys.executable, "-m", "benchmarks.wires.witness"]
    running = [subprocess.Popen([*command, str(core), str(file)]) for core, file in files.items()]
    try:
        yield list(files.values())
    finally:
        for each in running:
            each.terminate()
        for each in running:
            each.wait()


def seen(file: Path) -> np.ndarray:
    """Return what a witness has written, shape (N, 2): when a moment was due and how late it woke, s."""
    whole = np.fromfile(file) if file.exists() else np.zeros(0)
    return whole[: len(whole) // 2 * 2].reshape(-1, 2)


if __name__ == "__main__":
    watch(int(sys.argv[1]), Path(sys.argv[2]))
