"""One identification method in a process of its own: what it finds, how long it takes, how much memory.

`measured(job)` starts `python -m benchmarks.measured_process` and waits.  A method that takes the interpreter down with
it is a row that says so, and the memory is of that method alone.  Linear algebra has one thread.
"""

import os
import resource
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.identification_methods import METHODS, PROPOSALS, Matrices

MEMORY = 8 << 30
"""Bytes that a process may ask for."""
PATIENCE = 240.0
"""Seconds after which a process is ended."""
REPEATS, ENOUGH, COMPILING = 9, 3.0, 15.0
"""The first record is done so many times, or until s have gone by; the least time counts.  A second time is done for so
many s: the first may have compiled."""
BUDGET = 8.0
"""Seconds after which no further record is begun."""
_ROOT = Path(__file__).parents[1]
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Job:
    """What a process is to do.

    Parameters
    ----------
    method : str
        One of `METHODS`; of `PROPOSALS` where `order` is -1.
    order, horizon : int
    drives, responses : arrays, shapes (records, N, m) and (records, N, p), any unit
    """

    method: str
    order: int
    horizon: int
    drives: np.ndarray
    responses: np.ndarray


@dataclass(frozen=True)
class Outcome:
    """What came of it.

    Parameters
    ----------
    models : list of Matrices
        One a record that there was time for; none where orders were asked for, or it failed.
    orders : list of int
        Likewise.
    wall, cpu : float, s
        Of the first record: by the clock, and on the processor, the least of several.
    before, peak : float, MB
        Resident memory with packages and records loaded, and the most while the first record was done.
    failure : str
        Empty where it did not fail.
    """

    models: list[Matrices]
    orders: list[int]
    wall: float = np.nan
    cpu: float = np.nan
    before: float = np.nan
    peak: float = np.nan
    failure: str = ""


def measured(job: Job) -> Outcome:
    """Do a job in a new process."""
    with TemporaryDirectory() as folder:
        asked, answered = Path(folder) / "job.npz", Path(folder) / "outcome.npz"
        np.savez(asked, **vars(job))
        environment = os.environ | dict.fromkeys(_THREADS, "1") | {"MPLBACKEND": "agg"}
        command = [sys.executable, "-W", "ignore", "-m", "benchmarks.measured_process", str(asked), str(answered)]
        try:
            ended = subprocess.run(
                command, env=environment, cwd=_ROOT, capture_output=True, text=True, timeout=PATIENCE
            )
        except subprocess.TimeoutExpired:
            return Outcome([], [], failure=f"not done after {PATIENCE:.0f} s")
        if ended.returncode:
            return Outcome([], [], failure=_reason(ended.returncode, ended.stderr))
        return _read(answered)


def _reason(status: int, said: str) -> str:
    last = said.strip().splitlines()[-1:] or ["nothing said"]
    return f"the interpreter died of {signal.Signals(-status).name}: {last[0]}" if status < 0 else last[0]


def _read(path: Path) -> Outcome:
    with np.load(path) as content:
        figures = {name: float(content[name]) for name in ("wall", "cpu", "before", "peak")}
        models: list[Matrices] = [{} for _ in range(int(content["models"]))]
        for name in content.files:
            number, _, matrix = name.partition(":")
            if matrix:
                models[int(number)][matrix] = content[name]
        return Outcome(models, content["orders"].tolist(), **figures)


def _work(asked: str, answered: str) -> None:
    """Do the job that a file describes: import, measure memory on the first call, then time."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    with np.load(asked) as content:
        job = Job(*(content[name] if content[name].ndim else content[name].item() for name in Job.__annotations__))
    proposes = job.order < 0
    method = PROPOSALS[job.method]() if proposes else METHODS[job.method]()
    further = (job.horizon,) if proposes else (job.order, job.horizon)
    found, wall, cpu = [], np.inf, np.inf
    before = _restart_peak()
    peak = before
    began = time.perf_counter()
    for number, record in enumerate(zip(job.drives, job.responses, strict=True)):
        if number and time.perf_counter() - began > BUDGET:
            break
        start = time.perf_counter()
        for repeat in range(1 if number else REPEATS):
            if repeat and time.perf_counter() - start > (COMPILING if repeat == 1 else ENOUGH):
                break
            clock, processor = time.perf_counter(), time.process_time()
            result = method(*record, *further)
            cpu = min(cpu, time.process_time() - processor) if not number else cpu
            wall = min(wall, time.perf_counter() - clock) if not number else wall
            peak = peak if number or repeat else _status("VmHWM")
        found.append(result)
    figures = {"wall": wall, "cpu": cpu, "before": before, "peak": peak}
    matrices = {f"{n}:{name}": each for n, model in enumerate(found) if not proposes for name, each in model.items()}
    orders = found if proposes else [len(model["A"]) for model in found]
    np.savez(answered, models=0 if proposes else len(found), orders=orders, **figures, **matrices)


def _restart_peak() -> float:
    """Let the kernel's record of the peak begin here; return what is resident now, MB."""
    Path("/proc/self/clear_refs").write_text("5")
    return _status("VmRSS")


def _status(name: str) -> float:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith(name + ":"))


if __name__ == "__main__":
    try:
        _work(*sys.argv[1:])
    except Exception as error:
        sys.exit(f"{type(error).__name__}: {error}")
