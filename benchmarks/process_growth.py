"""What processes hold as time goes by, memory, open files and threads, and how quickly that grows."""

import os
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

DAY = 86_400.0


@dataclass(frozen=True)
class Held:
    """What one process held at one moment.

    Parameters
    ----------
    seconds : float, s since the first
    shot : int, shots recorded by then
    process : str
    pid : int
    rss, uss : float, MB
        Resident, and the part of it that is this process' alone.
    files, threads : int
    """

    seconds: float
    shot: int
    process: str
    pid: int
    rss: float
    uss: float
    files: int
    threads: int

    def row(self) -> str:
        """Return it as a line of CSV."""
        return ",".join(f"{value:.3f}" if isinstance(value, float) else str(value) for value in vars(self).values())


HEAD = ",".join(field.name for field in fields(Held))


def held(process: str, pid: int, seconds: float, shot: int) -> Held:
    """Look at a process.

    Raises
    ------
    OSError : it has ended.
    """
    place = Path(f"/proc/{pid}")
    kib = {
        name: int(value.split()[0])
        for name, _, value in (line.partition(":") for line in (place / "smaps_rollup").read_text().splitlines()[1:])
    }
    own = kib["Private_Clean"] + kib["Private_Dirty"]
    counts = len(os.listdir(place / "fd")), len(os.listdir(place / "task"))
    return Held(seconds, shot, process, pid, kib["Rss"] * 1.024e-3, own * 1.024e-3, *counts)


def growth(seconds: np.ndarray, size: np.ndarray) -> float:
    """Return the slope of the straight line through sizes, per day.

    Parameters
    ----------
    seconds : array, shape (samples,), s
    size : array, shape (samples,), any unit
    """
    return float(np.polyfit(seconds - seconds[0], size, 1)[0]) * DAY if len(size) > 1 else float("nan")


def table(samples: Iterable[Held], since: float) -> list[str]:
    """Return a line for each process that lived on from `since`, s, to the end."""
    late = [sample for sample in samples if sample.seconds >= since]
    lines = [f"{'process':8}{'RSS, MB':>16}{'MB/day':>8}{'USS, MB':>16}{'MB/day':>8}{'files':>9}{'threads':>9}"]
    for name in dict.fromkeys(sample.process for sample in late):
        own = [sample for sample in late if sample.process == name]
        if len({sample.pid for sample in own}) > 1:
            lines.append(f"{name:8} {len({sample.pid for sample in own})} of them, one after the other")
            continue
        at = np.array([sample.seconds for sample in own])
        line = f"{name:8}"
        for sizes in ([sample.rss for sample in own], [sample.uss for sample in own]):
            line += f"{f'{sizes[0]:.2f} {sizes[-1]:.2f}':>16}{growth(at, np.array(sizes)):>8.1f}"
        for counts in ([sample.files for sample in own], [sample.threads for sample in own]):
            line += f"{f'{min(counts)} to {max(counts)}':>9}"
        lines.append(line)
    return lines
