"""Warm worker processes on this machine: each performs a task at a time, and one that is killed costs its task only."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue
from threading import RLock, Timer
from typing import IO, Any

from rigkit.json_file import json_value
from rigkit.provenance import now
from rigkit.study.outcome import KILLED, TOO_LONG, Outcome
from rigkit.study.task import Task

KILLS, CRASHES = 10, 3
"""Times that a task is begun while its process is killed from outside, or by the system for want of memory; and while
it crashes.  After that it is recorded."""
_FROM_OUTSIDE = (-signal.SIGKILL, -signal.SIGTERM, -signal.SIGINT, -signal.SIGHUP)
ENVIRONMENT = {
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "PYTHONHASHSEED": "0",
    "MPLBACKEND": "agg",
}
"""Of every worker: one thread, since sums depend on how many there are; sets in the same order in every process."""


class Ended(Exception):
    """The workers were ended while a task was performed."""


class _Lost(Exception):
    """A process ended while it performed a task.

    Parameters
    ----------
    status : int
        As of `Popen.returncode`.
    is_late : bool
        Whether it was killed since the task took too long.
    """

    def __init__(self, status: int, is_late: bool) -> None:
        super().__init__(status, is_late)
        self.status, self.is_late = status, is_late


class Worker:
    """One warm process, begun when the first task comes, and anew when it has died.

    Parameters
    ----------
    files, scratch : Path
        As of `perform`.
    """

    def __init__(self, files: Path, scratch: Path) -> None:
        self._command = [sys.executable, "-P", "-m", "rigkit.study.worker", str(files), str(scratch)]
        self._process: subprocess.Popen[bytes] | None = None
        self._what: dict[str, Any] = {}
        self._lock, self._is_ended = RLock(), False

    @property
    def pid(self) -> int | None:
        """Number of the process, None where there is none."""
        return None if self._process is None else self._process.pid

    def perform(self, task: Task) -> Outcome:
        """Have a task performed, again where the process dies.

        Raises
        ------
        Ended : `end` was called.
        """
        began, killed, crashed = time.monotonic(), 0, 0
        while killed < KILLS and crashed < CRASHES:
            tries = killed + crashed + 1
            try:
                told = self._ask(task)
                return replace(Outcome.of(told), tries=tries, **self._what)
            except _Lost as end:
                if end.is_late:
                    return self._lost(task, TOO_LONG, f"killed after {task.seconds:g} s", tries, began)
                killed += end.status in _FROM_OUTSIDE
                crashed += end.status not in _FROM_OUTSIDE
                message = f"its process was ended {tries} times, the last by status {end.status}"
        return self._lost(task, KILLED, message, tries, began)

    def end(self) -> None:
        """Kill the process and all that it started; what it performs is lost."""
        with self._lock:
            self._is_ended = True
            self._kill()

    def _ask(self, task: Task) -> dict[str, Any]:
        """Return what the process tells of a task; _Lost where it died."""
        late: list[bool] = []
        process = self._begun()

        def kill() -> None:
            late.append(True)
            self._kill()

        timer = Timer(task.seconds, kill)
        timer.start()
        line = b""
        try:
            with suppress(OSError):  # it has died
                _pipe(process.stdin).write(f"{task.text}\n".encode())
                _pipe(process.stdin).flush()
                line = _pipe(process.stdout).readline()
        finally:
            timer.cancel()
        if line.endswith(b"\n"):
            return json_value(line.decode(), "an outcome", dict)
        self._kill()
        raise _Lost(process.wait(), bool(late))

    def _begun(self) -> subprocess.Popen[bytes]:
        """Return the process, begun where there is none."""
        with self._lock:
            if self._is_ended:
                raise Ended
            if self._process is not None:
                return self._process
            pipe, environment = subprocess.PIPE, {**os.environ, **ENVIRONMENT}
            # In a group of its own: Ctrl-C is for who began the study, and what it starts is killed with it.
            process = subprocess.Popen(self._command, stdin=pipe, stdout=pipe, env=environment, start_new_session=True)
            self._process = process
        line = _pipe(process.stdout).readline()
        if line.endswith(b"\n"):
            self._what = json_value(line.decode(), "a worker", dict)
        return process

    def _kill(self) -> None:
        """Kill the process and all that it started, if there is one."""
        with self._lock:
            process, self._process = self._process, None
        if process is None:
            return
        with suppress(ProcessLookupError):  # before it is waited for: until then its number is its own
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):  # what was not read any more
                _pipe(pipe).close()

    def _lost(self, task: Task, status: int, message: str, tries: int, began: float) -> Outcome:
        """Return the outcome of a task whose process was killed: it may have used all the time there was."""
        if not self._what:
            raise RuntimeError(f"a worker process cannot be started: {' '.join(self._command)}")
        wall, figures = time.monotonic() - began, dict.fromkeys(task.figures)
        lost = Outcome(task.key, status, 1, message, figures, wall, wall, now(), tries=tries)
        return replace(lost, **self._what)


def _pipe(pipe: IO[bytes] | None) -> IO[bytes]:
    """Return a pipe that was asked for."""
    if pipe is None:
        raise AssertionError("a process without pipes")
    return pipe


class Crew:
    """Several workers.

    Parameters
    ----------
    count : int
    files, scratch : Path
        As of `perform`.
    """

    def __init__(self, count: int, files: Path, scratch: Path) -> None:
        self.workers = [Worker(files, scratch) for _ in range(count)]
        self._idle: SimpleQueue[Worker] = SimpleQueue()
        for worker in self.workers:
            self._idle.put(worker)

    def perform(self, task: Task) -> Outcome:
        """Have a task performed by a worker that is idle; waits for one.

        Raises
        ------
        Ended : `end` was called.
        """
        worker = self._idle.get()
        try:
            return worker.perform(task)
        finally:
            self._idle.put(worker)

    def end(self) -> None:
        """End all workers at once."""
        for worker in self.workers:
            worker.end()
